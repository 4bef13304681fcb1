#include "core/hmm/scaled_kernels.h"

#include <algorithm>
#include <limits>

#include "core/hmm/highway_targets.h"

// Highway includes this file again for every instruction set.
// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/hmm/scaled_kernels.cc"
#include "hwy/foreach_target.h"
#include "core/hmm/scaled_cells-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace tactus::internal {
namespace HWY_NAMESPACE {

// kJumps 0: any number of them.
template <typename T, bool kBest, int kJumps>
void PredictCells(const PredictStep<T>& step) {
  const Vector<T> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int j = 0; j < step.cells; j += lanes) {
    const Cells<T> share = PredictVector<T, kBest, kJumps>(step, j);
    hn::Store(share.mantissa, d, step.to.mantissa + j);
    hn::Store(share.exponent, d, step.to.exponent + j);
  }
}

template <typename T>
void PredictAny(const PredictStep<T>& step) {
  if (step.jumps == 2) {
    return step.best ? PredictCells<T, true, 2>(step)
                     : PredictCells<T, false, 2>(step);
  }
  return step.best ? PredictCells<T, true, 0>(step)
                   : PredictCells<T, false, 0>(step);
}

// Stores the result of `shares` for the cells from j on, at place p in the
// patterns, and their largest exponents.
template <typename T, class Function>
HWY_INLINE void WeighEach(const WeighStep<T>& step, const Function& shares) {
  const Vector<T> d;
  using V = hn::Vec<decltype(d)>;
  const int lanes = static_cast<int>(hn::Lanes(d));
  // Patterns of one vector stay in a register.
  const bool in_register = step.period == lanes;
  V largest_of_all = hn::Set(d, std::numeric_limits<T>::lowest());
  if (!in_register) {
    std::fill_n(step.largest_exponent, step.period,
                std::numeric_limits<T>::lowest());
  }
  int p = 0;
  for (int j = 0; j < step.cells; j += lanes) {
    const Cells<T> share = shares(j, p);
    hn::Store(share.mantissa, d, step.to.mantissa + j);
    hn::Store(share.exponent, d, step.to.exponent + j);
    if (in_register) {
      largest_of_all = hn::Max(largest_of_all, share.exponent);
      continue;
    }
    T* largest = step.largest_exponent + p;
    hn::Store(hn::Max(hn::Load(d, largest), share.exponent), d, largest);
    p = p + lanes < step.period ? p + lanes : 0;
  }
  if (in_register) hn::Store(largest_of_all, d, step.largest_exponent);
}

// kDimensions 0: any number of them.
template <typename T, int kDimensions, bool kFull>
void WeighCells(const WeighStep<T>& step) {
  const Vector<T> d;
  WeighEach(step, [&](int j, int p) {
    const Cells<T> density =
        PowerOfBits<T>(DensityBits<T, kDimensions, kFull>(step, j, p));
    return Cells<T>{
        hn::Mul(hn::Load(d, step.from.mantissa + j), density.mantissa),
        hn::Add(hn::Load(d, step.from.exponent + j),
                hn::Sub(density.exponent, hn::Load(d, step.lowered + p)))};
  });
}

template <typename T>
void WeighAny(const WeighStep<T>& step) {
  switch (step.dimensions) {
    case 1:
      return WeighCells<T, 1, false>(step);
    case 2:
      return step.full ? WeighCells<T, 2, true>(step)
                       : WeighCells<T, 2, false>(step);
    case 3:
      return step.full ? WeighCells<T, 3, true>(step)
                       : WeighCells<T, 3, false>(step);
    default:
      return step.full ? WeighCells<T, 0, true>(step)
                       : WeighCells<T, 0, false>(step);
  }
}

// The return value of Advance.
template <typename T>
bool KeptDigits(const WeighStep<T>& step) {
  const Vector<T> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto lowest = hn::Set(d, Scaled<T>::kTrusted);
  const auto highest = hn::Set(d, -Scaled<T>::kTrusted);
  bool all_above = true;
  for (int p = 0; p < step.period; p += lanes) {
    const auto largest = hn::Load(d, step.largest_exponent + p);
    if (!hn::AllTrue(d, hn::Lt(largest, highest))) return false;
    all_above = all_above && hn::AllTrue(d, hn::Gt(largest, lowest));
  }
  // One entry of each component is enough.
  for (int k = 0; !all_above && k < step.stride; ++k) {
    T largest = step.largest_exponent[k];
    for (int p = k + step.stride; p < step.period; p += step.stride) {
      largest = std::max(largest, step.largest_exponent[p]);
    }
    if (!(largest > Scaled<T>::kTrusted)) return false;
  }
  return true;
}

template <typename T, bool kBest, int kJumps, int kDimensions, bool kFull>
bool AdvanceCells(const AdvanceStep<T>& step) {
  const Vector<T> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  // Two short loops, because the steps of one long loop would wait for each
  // other.
  T* bits = step.weigh.to.exponent;
  int place = 0;
  for (int j = 0; j < step.weigh.cells; j += lanes) {
    hn::Store(DensityBits<T, kDimensions, kFull>(step.weigh, j, place), d,
              bits + j);
    place = place + lanes < step.weigh.period ? place + lanes : 0;
  }
  WeighEach(step.weigh, [&](int j, int) {
    const Cells<T> before = PredictVector<T, kBest, kJumps>(step.predict, j);
    const Cells<T> density = PowerOfBits<T>(hn::Load(d, bits + j));
    return Cells<T>{hn::Mul(before.mantissa, density.mantissa),
                    hn::Add(before.exponent, density.exponent)};
  });
  return KeptDigits(step.weigh);
}

template <typename T, bool kBest>
bool AdvanceAny(const AdvanceStep<T>& step) {
  const bool full = step.weigh.full;
  if (step.predict.jumps == 2) {
    switch (step.weigh.dimensions) {
      case 1:
        return AdvanceCells<T, kBest, 2, 1, false>(step);
      case 2:
        return full ? AdvanceCells<T, kBest, 2, 2, true>(step)
                    : AdvanceCells<T, kBest, 2, 2, false>(step);
      case 3:
        return full ? AdvanceCells<T, kBest, 2, 3, true>(step)
                    : AdvanceCells<T, kBest, 2, 3, false>(step);
      default:
        break;
    }
  }
  return full ? AdvanceCells<T, kBest, 0, 0, true>(step)
              : AdvanceCells<T, kBest, 0, 0, false>(step);
}

template <typename T>
void FindLargestAny(const Reduction<T>& step) {
  const Vector<T> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  std::fill_n(step.largest_exponent, step.period,
              std::numeric_limits<T>::lowest());
  int p = 0;
  for (int j = 0; j < step.cells; j += lanes) {
    T* largest = step.largest_exponent + p;
    hn::Store(
        hn::Max(hn::Load(d, largest), hn::Load(d, step.shares.exponent + j)), d,
        largest);
    p = p + lanes < step.period ? p + lanes : 0;
  }
}

template <typename T>
void TotalAny(const Reduction<T>& step) {
  const Vector<T> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  std::fill_n(step.total, step.period, T{0});
  int p = 0;
  for (int j = 0; j < step.cells; j += lanes) {
    T* total = step.total + p;
    const auto behind = hn::Sub(hn::Load(d, step.shares.exponent + j),
                                hn::Load(d, step.largest_exponent + p));
    const auto share =
        hn::Mul(hn::Load(d, step.shares.mantissa + j), PowerOfTwo(d, behind));
    const auto before = hn::Load(d, total);
    hn::Store(step.best ? hn::Max(before, share) : hn::Add(before, share), d,
              total);
    p = p + lanes < step.period ? p + lanes : 0;
  }
}

void PredictFloat(const PredictStep<float>& step) { PredictAny(step); }
void PredictDouble(const PredictStep<double>& step) { PredictAny(step); }
void WeighFloat(const WeighStep<float>& step) { WeighAny(step); }
void WeighDouble(const WeighStep<double>& step) { WeighAny(step); }
bool AdvanceFloat(const AdvanceStep<float>& step) {
  return step.predict.best ? AdvanceAny<float, true>(step)
                           : AdvanceAny<float, false>(step);
}
bool AdvanceDouble(const AdvanceStep<double>& step) {
  return step.predict.best ? AdvanceAny<double, true>(step)
                           : AdvanceAny<double, false>(step);
}
void FindLargestFloat(const Reduction<float>& step) { FindLargestAny(step); }
void FindLargestDouble(const Reduction<double>& step) { FindLargestAny(step); }
void TotalFloat(const Reduction<float>& step) { TotalAny(step); }
void TotalDouble(const Reduction<double>& step) { TotalAny(step); }

}  // namespace HWY_NAMESPACE
}  // namespace tactus::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tactus::internal {

HWY_EXPORT(PredictFloat);
HWY_EXPORT(PredictDouble);
HWY_EXPORT(WeighFloat);
HWY_EXPORT(WeighDouble);
HWY_EXPORT(AdvanceFloat);
HWY_EXPORT(AdvanceDouble);
HWY_EXPORT(FindLargestFloat);
HWY_EXPORT(FindLargestDouble);
HWY_EXPORT(TotalFloat);
HWY_EXPORT(TotalDouble);

void Predict(const PredictStep<float>& step) {
  HWY_DYNAMIC_DISPATCH(PredictFloat)(step);
}
void Predict(const PredictStep<double>& step) {
  HWY_DYNAMIC_DISPATCH(PredictDouble)(step);
}
void Weigh(const WeighStep<float>& step) {
  HWY_DYNAMIC_DISPATCH(WeighFloat)(step);
}
void Weigh(const WeighStep<double>& step) {
  HWY_DYNAMIC_DISPATCH(WeighDouble)(step);
}
bool Advance(const AdvanceStep<float>& step) {
  return HWY_DYNAMIC_DISPATCH(AdvanceFloat)(step);
}
bool Advance(const AdvanceStep<double>& step) {
  return HWY_DYNAMIC_DISPATCH(AdvanceDouble)(step);
}
void FindLargest(const Reduction<float>& step) {
  HWY_DYNAMIC_DISPATCH(FindLargestFloat)(step);
}
void FindLargest(const Reduction<double>& step) {
  HWY_DYNAMIC_DISPATCH(FindLargestDouble)(step);
}
void Total(const Reduction<float>& step) {
  HWY_DYNAMIC_DISPATCH(TotalFloat)(step);
}
void Total(const Reduction<double>& step) {
  HWY_DYNAMIC_DISPATCH(TotalDouble)(step);
}

}  // namespace tactus::internal
#endif  // HWY_ONCE
