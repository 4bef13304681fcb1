// File: scaled_cells-inl.h
//
// One vector of cells of the kernels in scaled_kernels.h: what its states are
// predicted to hold, and what an observation says of them. Included once for
// each instruction set by Highway, like scaled_math-inl.h.
//
//   Cells<float> share = PredictVector<float, false, 2>(step, j);
//
// Thread-safe: free functions.
#if defined(TACTUS_CORE_HMM_SCALED_CELLS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef TACTUS_CORE_HMM_SCALED_CELLS_INL_H_
#undef TACTUS_CORE_HMM_SCALED_CELLS_INL_H_
#else
#define TACTUS_CORE_HMM_SCALED_CELLS_INL_H_
#endif

#include "core/base/limits.h"
#include "core/hmm/scaled_kernels.h"
#include "core/hmm/scaled_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tactus {
namespace HWY_NAMESPACE {

// Shares of a vector of cells.
template <typename T>
struct Cells {
  hn::Vec<Vector<T>> mantissa;
  hn::Vec<Vector<T>> exponent;
};

// The cells from j on. kJumps 0: any number of them.
template <typename T, bool kBest, int kJumps>
HWY_INLINE Cells<T> PredictVector(const PredictStep<T>& step, int j) {
  const Vector<T> d;
  using V = hn::Vec<decltype(d)>;
  const int jumps = kJumps > 0 ? kJumps : step.jumps;
  const T* parameters = step.transitions +
                        static_cast<size_t>(j / kBlock) * jumps * 2 * kBlock +
                        j % kBlock;
  const ptrdiff_t source =
      j - static_cast<ptrdiff_t>(step.first_jump) * step.stride;
  V exponent = hn::Set(d, 2 * Scaled<T>::kNothing);
  for (int q = 0; q < jumps; ++q) {
    const ptrdiff_t i = source - static_cast<ptrdiff_t>(q) * step.stride;
    exponent = hn::Max(exponent,
                       hn::Add(hn::LoadU(d, step.from.exponent + i),
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
  return {mantissa, exponent};
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

// The densities of the cells from j on, at place p in the patterns.
// kDimensions 0: any number of them.
template <typename T, int kDimensions, bool kFull>
HWY_INLINE Cells<T> DensityVector(const WeighStep<T>& step, int j, int p) {
  const Vector<T> d;
  using V = hn::Vec<decltype(d)>;
  const int dimensions = kDimensions > 0 ? kDimensions : step.dimensions;
  const int rows = (sizeof(T) == sizeof(float) ? 2 : 1) * dimensions +
                   (kFull ? dimensions * (dimensions + 1) / 2 : dimensions) + 1;
  const T* row = step.emissions +
                 static_cast<size_t>(j / kBlock) * rows * kBlock + j % kBlock;
  const V distance = Distance<T, kDimensions, kFull>(step, p, row);
  const V bits = hn::Sub(hn::Load(d, row), distance);
  const V whole = hn::Round(bits);
  return {PowerOfFraction(d, hn::Sub(bits, whole)), whole};
}

}  // namespace HWY_NAMESPACE
}  // namespace tactus
HWY_AFTER_NAMESPACE();

#endif
