#include "core/hmm/scaled_kernels.h"

#include <algorithm>
#include <limits>

#include "core/base/limits.h"
#include "core/hmm/highway_targets.h"

// Highway includes this file again for every instruction set.
// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/hmm/scaled_kernels.cc"
#include "hwy/foreach_target.h"
#include "core/hmm/scaled_math-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace tactus {
namespace HWY_NAMESPACE {

// kJumps 0: any number of them.
template <typename T, bool kBest, int kJumps>
void PredictCells(const PredictStep<T>& step) {
  const Vector<T> d;
  using V = hn::Vec<decltype(d)>;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int jumps = kJumps > 0 ? kJumps : step.jumps;
  for (int j = 0; j < step.cells; j += lanes) {
    const T* parameters = step.transitions +
                          static_cast<size_t>(j / kBlock) * jumps * 2 * kBlock +
                          j % kBlock;
    const ptrdiff_t source =
        j - static_cast<ptrdiff_t>(step.first_jump) * step.stride;
    V exponent = hn::Set(d, 2 * Scaled<T>::kNothing);
    for (int q = 0; q < jumps; ++q) {
      const ptrdiff_t i = source - static_cast<ptrdiff_t>(q) * step.stride;
      exponent = hn::Max(
          exponent, hn::Add(hn::LoadU(d, step.from.exponent + i),
                            hn::Load(d, parameters + (2 * q + 1) * kBlock)));
    }
    V mantissa = hn::Zero(d);
    for (int q = 0; q < jumps; ++q) {
      const ptrdiff_t i = source - static_cast<ptrdiff_t>(q) * step.stride;
      const V behind =
          hn::Sub(hn::Add(hn::LoadU(d, step.from.exponent + i),
                          hn::Load(d, parameters + (2 * q + 1) * kBlock)),
                  exponent);
      const V weight = hn::Mul(hn::Load(d, parameters + 2 * q * kBlock),
                               PowerOfTwo(d, behind));
      const V from = hn::LoadU(d, step.from.mantissa + i);
      mantissa = kBest ? hn::Max(mantissa, hn::Mul(from, weight))
                       : hn::MulAdd(from, weight, mantissa);
    }
    Renormalise(d, mantissa, exponent);
    hn::Store(mantissa, d, step.to.mantissa + j);
    hn::Store(exponent, d, step.to.exponent + j);
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

// z = (inverse factor) (x - mean); returns |z|^2, which is in bits. p: place in
// the patterns.
template <typename T, int kDimensions, bool kFull>
HWY_INLINE hn::Vec<Vector<T>> Distance(const WeighStep<T>& step,
                                       [[maybe_unused]] int p, const T*& row) {
  const Vector<T> d;
  using V = hn::Vec<decltype(d)>;
  const int dimensions = kDimensions > 0 ? kDimensions : step.dimensions;
  const auto next = [&] {
    const V value = hn::Load(d, row);
    row += kBlock;
    return value;
  };
  V difference[kDimensions > 0 ? kDimensions : limits::kMaxHmmDimensions];
  V distance = hn::Zero(d);
  for (int i = 0; i < dimensions; ++i) {
    V z;
    if constexpr (sizeof(T) == sizeof(float)) {
      // With what rounding x and the mean to float has left.
      difference[i] = hn::Add(hn::Sub(hn::Set(d, step.x[i]), next()),
                              hn::Set(d, step.x[dimensions + i]));
      const V mean_rest = next();
      z = hn::MulSub(next(), difference[i], mean_rest);
    } else {
      difference[i] =
          hn::Sub(hn::Load(d, step.x + i * step.period + p), next());
      z = hn::Mul(next(), difference[i]);
    }
    for (int j = 0; kFull && j < i; ++j) {
      z = hn::MulAdd(next(), difference[j], z);
    }
    distance = hn::MulAdd(z, z, distance);
  }
  // Written so that what is not a number takes the ceiling too.
  const V farthest = hn::Set(d, Scaled<T>::kFarthest);
  return hn::IfThenElse(hn::Lt(distance, farthest), distance, farthest);
}

// kDimensions 0: any number of them.
template <typename T, int kDimensions, bool kFull>
void WeighCells(const WeighStep<T>& step) {
  const Vector<T> d;
  using V = hn::Vec<decltype(d)>;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int dimensions = kDimensions > 0 ? kDimensions : step.dimensions;
  const int rows = (sizeof(T) == sizeof(float) ? 2 : 1) * dimensions +
                   (kFull ? dimensions * (dimensions + 1) / 2 : dimensions) + 1;
  V largest_of_all = hn::Set(d, std::numeric_limits<T>::lowest());
  if (step.stride > 1) {
    std::fill_n(step.largest_exponent, step.period,
                std::numeric_limits<T>::lowest());
  }
  int p = 0;
  for (int j = 0; j < step.cells; j += lanes) {
    const T* row = step.emissions +
                   static_cast<size_t>(j / kBlock) * rows * kBlock + j % kBlock;
    const V distance = Distance<T, kDimensions, kFull>(step, p, row);
    const V bits = hn::Sub(hn::Load(d, row), distance);
    const V whole = hn::Round(bits);
    const V mantissa = hn::Mul(hn::Load(d, step.from.mantissa + j),
                               PowerOfFraction(d, hn::Sub(bits, whole)));
    const V exponent = hn::Add(hn::Load(d, step.from.exponent + j),
                               hn::Sub(whole, hn::Load(d, step.lowered + p)));
    hn::Store(mantissa, d, step.to.mantissa + j);
    hn::Store(exponent, d, step.to.exponent + j);
    if (step.stride == 1) {
      largest_of_all = hn::Max(largest_of_all, exponent);
      continue;
    }
    T* largest = step.largest_exponent + p;
    hn::Store(hn::Max(hn::Load(d, largest), exponent), d, largest);
    p = p + lanes < step.period ? p + lanes : 0;
  }
  if (step.stride == 1) {
    largest_of_all = hn::MaxOfLanes(d, largest_of_all);
    for (p = 0; p < step.period; p += lanes) {
      hn::Store(largest_of_all, d, step.largest_exponent + p);
    }
  }
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
void FindLargestFloat(const Reduction<float>& step) { FindLargestAny(step); }
void FindLargestDouble(const Reduction<double>& step) { FindLargestAny(step); }
void TotalFloat(const Reduction<float>& step) { TotalAny(step); }
void TotalDouble(const Reduction<double>& step) { TotalAny(step); }

const char* TargetName() { return hwy::TargetName(HWY_TARGET); }

}  // namespace HWY_NAMESPACE
}  // namespace tactus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tactus {

HWY_EXPORT(PredictFloat);
HWY_EXPORT(PredictDouble);
HWY_EXPORT(WeighFloat);
HWY_EXPORT(WeighDouble);
HWY_EXPORT(FindLargestFloat);
HWY_EXPORT(FindLargestDouble);
HWY_EXPORT(TotalFloat);
HWY_EXPORT(TotalDouble);
HWY_EXPORT(TargetName);

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

const char* KernelTarget() { return HWY_DYNAMIC_DISPATCH(TargetName)(); }

}  // namespace tactus
#endif  // HWY_ONCE
