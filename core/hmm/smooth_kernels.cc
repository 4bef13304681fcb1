#include "core/hmm/smooth_kernels.h"

#include "core/base/limits.h"
#include "core/hmm/highway_targets.h"

// Highway includes this file again for every instruction set.
// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/hmm/smooth_kernels.cc"
#include "hwy/foreach_target.h"
#include "core/hmm/scaled_math-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace tactus {
namespace HWY_NAMESPACE {

// Shares of a state below this add nothing to any sum.
constexpr double kNegligibleShare = 1e-30;

// 2^n for whole n, 0 where that is negligible; n is held below 2^4.
template <class D, class V>
HWY_INLINE V PowerOrZero(D d, V n) {
  return hn::IfThenZeroElse(hn::Lt(n, hn::Set(d, -400.0)),
                            PowerOfTwo(d, hn::Min(n, hn::Set(d, 4.0))));
}

template <class D, class V>
HWY_INLINE V Flush(D d, V share) {
  return hn::IfThenZeroElse(hn::Lt(share, hn::Set(d, kNegligibleShare)), share);
}

void SmoothCells(const SmoothStep& step) {
  const Vector<double> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int j = 0; j < step.cells; j += lanes) {
    // The division does not wait for the share, which the last step wrote.
    const auto inverse =
        hn::Div(hn::Set(d, 1.0), hn::Load(d, step.predicted.mantissa + j));
    hn::Store(hn::Mul(hn::Load(d, step.share_next + j), inverse), d,
              step.quotient + j);
  }
  for (int i = 0; i < step.cells; i += lanes) {
    const auto mantissa = hn::Load(d, step.belief.mantissa + i);
    const auto exponent = hn::Load(d, step.belief.exponent + i);
    auto share = hn::Zero(d);
    for (int q = 0; q < step.jumps; ++q) {
      const ptrdiff_t j =
          i + static_cast<ptrdiff_t>(step.first_jump + q) * step.stride;
      const size_t cell = q * step.plane + i;
      const auto power =
          hn::Sub(hn::Add(exponent, hn::Load(d, step.exponent + cell)),
                  hn::LoadU(d, step.predicted.exponent + j));
      const auto ratio =
          hn::Mul(hn::Mul(mantissa, hn::Load(d, step.mantissa + cell)),
                  PowerOrZero(d, power));
      const auto taken = hn::Mul(hn::LoadU(d, step.quotient + j), ratio);
      hn::Store(hn::Add(hn::Load(d, step.taken + cell), taken), d,
                step.taken + cell);
      share = hn::Add(share, taken);
    }
    hn::Store(Flush(d, share), d, step.share + i);
  }
}

void NormaliseCells(const NormaliseStep& step) {
  const Vector<double> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int j = 0; j < step.cells; j += lanes) {
    const auto power = PowerOrZero(
        d, hn::Sub(hn::Load(d, step.shares.exponent + j),
                   hn::Load(d, step.largest_exponent + j % kPattern<double>)));
    const auto share =
        hn::Div(hn::Mul(hn::Load(d, step.shares.mantissa + j), power),
                hn::Load(d, step.total + j % kPattern<double>));
    hn::Store(Flush(d, share), d, step.share + j);
  }
}

// kDimensions 0: any number of them.
template <int kDimensions, bool kFull>
void AddMomentsOf(const MomentStep& step) {
  const Vector<double> d;
  using V = hn::Vec<decltype(d)>;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int dimensions = kDimensions > 0 ? kDimensions : step.dimensions;
  for (int j = 0; j < step.cells; j += lanes) {
    double* sum = step.moments + j;
    const auto add = [&](V value) {
      hn::Store(hn::Add(hn::Load(d, sum), value), d, sum);
      sum += step.plane;
    };
    const V share = hn::Load(d, step.share + j);
    const auto none = hn::Eq(share, hn::Zero(d));
    add(share);
    V difference[kDimensions > 0 ? kDimensions : limits::kMaxHmmDimensions];
    for (int a = 0; a < dimensions; ++a) {
      // What a state has no share in may be too far away for a square.
      difference[a] = hn::IfThenZeroElse(
          none, hn::Sub(hn::Load(d, step.x + a * kPattern<double> +
                                        j % kPattern<double>),
                        hn::Load(d, step.means + a * step.plane + j)));
      const V weighted = hn::Mul(share, difference[a]);
      add(weighted);
      for (int b = kFull ? 0 : a; b <= a; ++b) {
        add(hn::Mul(weighted, difference[b]));
      }
    }
  }
}

void AddMomentsOfCells(const MomentStep& step) {
  if (step.full && step.dimensions == 3) return AddMomentsOf<3, true>(step);
  return step.full ? AddMomentsOf<0, true>(step) : AddMomentsOf<0, false>(step);
}

}  // namespace HWY_NAMESPACE
}  // namespace tactus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tactus {

HWY_EXPORT(SmoothCells);
HWY_EXPORT(NormaliseCells);
HWY_EXPORT(AddMomentsOfCells);

void Smooth(const SmoothStep& step) { HWY_DYNAMIC_DISPATCH(SmoothCells)(step); }
void Normalise(const NormaliseStep& step) {
  HWY_DYNAMIC_DISPATCH(NormaliseCells)(step);
}
void AddMoments(const MomentStep& step) {
  HWY_DYNAMIC_DISPATCH(AddMomentsOfCells)(step);
}

}  // namespace tactus
#endif  // HWY_ONCE
