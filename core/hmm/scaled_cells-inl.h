// File: scaled_cells-inl.h
//
// One vector of cells of the kernels in scaled_kernels.h: the predicted shares
// of its states, and their densities at an observation. Highway includes this
// file once per instruction set, like scaled_math-inl.h.
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
namespace tactus::internal {
namespace HWY_NAMESPACE {

// Shares of a vector of cells.
template <typename T>
struct Cells {
  hn::Vec<Vector<T>> mantissa;
  hn::Vec<Vector<T>> exponent;
};

// The transitions into the cells from j on, by jump. kJumps 0: any number.
template <typename T, int kJumps>
class Sources {
 public:
  using V = hn::Vec<Vector<T>>;

  HWY_INLINE Sources(const PredictStep<T>& step, int j)
      : count_(kJumps > 0 ? kJumps : step.jumps),
        stride_(step.stride),
        parameters_(step.transitions +
                    static_cast<size_t>(j / kBlock) * count_ * 2 * kBlock +
                    j % kBlock),
        mantissa_(step.from.mantissa + Start(step, j)),
        exponent_(step.from.exponent + Start(step, j)) {}

  HWY_INLINE int count() const { return count_; }
  // The source state's share times the transition probability: its exponent, ..
  HWY_INLINE V Exponent(int q) const {
    return hn::Add(hn::LoadU(d_, exponent_ - q * stride_),
                   hn::Load(d_, parameters_ + (2 * q + 1) * ptrdiff_t{kBlock}));
  }
  HWY_INLINE V LargestExponent() const {
    V largest = Exponent(0);
    for (int q = 1; q < count_; ++q) largest = hn::Max(largest, Exponent(q));
    return largest;
  }
  // .. and the factors of its mantissa over 2^exponent.
  HWY_INLINE V From(int q) const {
    return hn::LoadU(d_, mantissa_ - q * stride_);
  }
  HWY_INLINE V Weight(int q, V exponent) const {
    return hn::Mul(hn::Load(d_, parameters_ + 2 * q * ptrdiff_t{kBlock}),
                   PowerOfTwo(d_, hn::Sub(Exponent(q), exponent)));
  }

 private:
  static HWY_INLINE ptrdiff_t Start(const PredictStep<T>& step, int j) {
    return j - static_cast<ptrdiff_t>(step.first_jump) * step.stride;
  }

  static constexpr Vector<T> d_{};
  const int count_;
  const ptrdiff_t stride_;
  const T* const parameters_;
  const T* const mantissa_;
  const T* const exponent_;
};

// The cells from j on. kJumps 0: any number of jumps.
template <typename T, bool kBest, int kJumps>
HWY_INLINE Cells<T> PredictVector(const PredictStep<T>& step, int j) {
  const Vector<T> d;
  using V = hn::Vec<decltype(d)>;
  const Sources<T, kJumps> sources(step, j);
  V exponent = sources.LargestExponent();
  V mantissa = hn::Zero(d);
  for (int q = 0; q < sources.count(); ++q) {
    const V weight = sources.Weight(q, exponent);
    const V from = sources.From(q);
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
      // Adds the rounding errors of x and of the mean.
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
  // The comparison is written so that NaN takes the ceiling too.
  const V farthest = hn::Set(d, Scaled<T>::kFarthest);
  return hn::IfThenElse(hn::Lt(distance, farthest), distance, farthest);
}

// log2 of the densities of the cells from j on, at place p in the patterns.
// kDimensions 0: any number of them.
template <typename T, int kDimensions, bool kFull>
HWY_INLINE hn::Vec<Vector<T>> DensityBits(const WeighStep<T>& step, int j,
                                          int p) {
  const Vector<T> d;
  const int dimensions = kDimensions > 0 ? kDimensions : step.dimensions;
  const int rows = (sizeof(T) == sizeof(float) ? 2 : 1) * dimensions +
                   (kFull ? dimensions * (dimensions + 1) / 2 : dimensions) + 1;
  const T* row = step.emissions +
                 static_cast<size_t>(j / kBlock) * rows * kBlock + j % kBlock;
  const auto distance = Distance<T, kDimensions, kFull>(step, p, row);
  return hn::Sub(hn::Load(d, row), distance);
}

// 2^bits; its mantissa is in [0.7, 1.5).
template <typename T>
HWY_INLINE Cells<T> PowerOfBits(hn::Vec<Vector<T>> bits) {
  const Vector<T> d;
  const auto whole = hn::Round(bits);
  return {PowerOfFraction(d, hn::Sub(bits, whole)), whole};
}

}  // namespace HWY_NAMESPACE
}  // namespace tactus::internal
HWY_AFTER_NAMESPACE();

#endif
