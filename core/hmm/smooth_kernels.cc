#include "core/hmm/smooth_kernels.h"

#include "core/base/limits.h"
#include "core/hmm/highway_targets.h"

// Highway includes this file again for every instruction set.
// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/hmm/smooth_kernels.cc"
#include "hwy/foreach_target.h"
#include "core/hmm/scaled_cells-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace tactus::internal {
namespace HWY_NAMESPACE {

// Shares below this change no sum.
constexpr double kNegligibleShare = 1e-30;

template <class D, class V>
HWY_INLINE V Flush(D d, V share) {
  return hn::IfThenZeroElse(hn::Lt(share, hn::Set(d, kNegligibleShare)), share);
}

// kJumps 0: any number. The step is a copy, so the compiler knows that no store
// changes it.
template <int kJumps>
void SmoothOf(const SmoothStep step) {
  const Vector<double> d;
  using V = hn::Vec<decltype(d)>;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int j = 0; j < step.predict.cells; j += lanes) {
    const Sources<double, kJumps> sources(step.predict, j);
    const V exponent = sources.LargestExponent();
    V part[kJumps > 0 ? kJumps : 2 * limits::kMaxHmmStates];
    V total = hn::Zero(d);
    for (int q = 0; q < sources.count(); ++q) {
      part[q] = hn::Mul(sources.From(q), sources.Weight(q, exponent));
      total = hn::Add(total, part[q]);
    }
    const V scale = hn::Div(hn::Load(d, step.share_next + j), total);
    for (int q = 0; q < sources.count(); ++q) {
      const V taken = hn::Mul(part[q], scale);
      const size_t cell = q * step.pitch + j;
      hn::Store(taken, d, step.taken_now + cell);
      hn::Store(hn::Add(hn::Load(d, step.taken + cell), taken), d,
                step.taken + cell);
    }
  }
  const int jumps = kJumps > 0 ? kJumps : step.predict.jumps;
  for (int i = 0; i < step.predict.cells; i += lanes) {
    const ptrdiff_t j = i + static_cast<ptrdiff_t>(step.predict.first_jump) *
                                step.predict.stride;
    V share = hn::Zero(d);
    for (int q = 0; q < jumps; ++q) {
      const ptrdiff_t offset =
          static_cast<ptrdiff_t>(step.pitch) + step.predict.stride;
      share = hn::Add(share, hn::LoadU(d, step.taken_now + j + q * offset));
    }
    hn::Store(Flush(d, share), d, step.share + i);
  }
}

void SmoothCells(const SmoothStep& step) {
  return step.predict.jumps == 2 ? SmoothOf<2>(step) : SmoothOf<0>(step);
}

void NormaliseCells(const NormaliseStep& step) {
  const Vector<double> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int j = 0; j < step.cells; j += lanes) {
    const int p = j % kPattern<double>;
    const auto power =
        PowerOfTwo(d, hn::Sub(hn::Load(d, step.shares.exponent + j),
                              hn::Load(d, step.largest_exponent + p)));
    const auto share =
        hn::Div(hn::Mul(hn::Load(d, step.shares.mantissa + j), power),
                hn::Load(d, step.total + p));
    hn::Store(Flush(d, share), d, step.share + j);
  }
}

// kDimensions 0: any number of them.
template <int kDimensions, bool kFull>
void AddMomentsOf(const MomentStep& step) {
  constexpr int kMost =
      kDimensions > 0 ? kDimensions : limits::kMaxHmmDimensions;
  const Vector<double> d;
  using V = hn::Vec<decltype(d)>;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int dimensions = kDimensions > 0 ? kDimensions : step.dimensions;
  const int planes =
      1 + dimensions + (kFull ? dimensions * (dimensions + 1) / 2 : dimensions);
  for (int j = 0; j < step.cells; j += lanes) {
    V mean[kMost];
    for (int a = 0; a < dimensions; ++a) {
      mean[a] = hn::Load(d, step.means + a * step.plane + j);
    }
    V sum[1 + kMost + (kFull ? kMost * (kMost + 1) / 2 : kMost)];
    for (int k = 0; k < planes; ++k) {
      sum[k] = hn::Load(d, step.moments + k * step.plane + j);
    }
    const double* x = step.x + j % kPattern<double>;
    const double* shares = step.share + j;
    for (int t = 0; t < step.frames; ++t) {
      const V share = hn::Load(d, shares);
      const auto none = hn::Eq(share, hn::Zero(d));
      int k = 0;
      sum[k] = hn::Add(sum[k], share);
      V difference[kMost];
      for (int a = 0; a < dimensions; ++a) {
        // A state with a share of zero may be infinitely far away.
        difference[a] = hn::IfThenZeroElse(
            none, hn::Sub(hn::Load(d, x + a * kPattern<double>), mean[a]));
        const V weighted = hn::Mul(share, difference[a]);
        ++k;
        sum[k] = hn::Add(sum[k], weighted);
        for (int b = kFull ? 0 : a; b <= a; ++b) {
          ++k;
          sum[k] = hn::MulAdd(weighted, difference[b], sum[k]);
        }
      }
      x += dimensions * kPattern<double>;
      shares += step.share_pitch;
    }
    for (int k = 0; k < planes; ++k) {
      hn::Store(sum[k], d, step.moments + k * step.plane + j);
    }
  }
}

void AddMomentsOfCells(const MomentStep& step) {
  if (step.full && step.dimensions == 3) return AddMomentsOf<3, true>(step);
  return step.full ? AddMomentsOf<0, true>(step) : AddMomentsOf<0, false>(step);
}

}  // namespace HWY_NAMESPACE
}  // namespace tactus::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tactus::internal {

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

}  // namespace tactus::internal
#endif  // HWY_ONCE
