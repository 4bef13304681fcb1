// File: scaled_kernels.h
//
// The forward algorithm and Viterbi for many HMMs side by side, vectorised for
// every CPU with run-time dispatch (Highway). Used through ScaledModel and
// ScaledFilter.
//
// Every share of a state is mantissa * 2^exponent, the exponent a whole number
// held in the same floating-point type. So nothing underflows, a state may lag
// any distance and win again, and a frame costs no logarithm and no exponential
// but that of a fraction of a bit. In a sum, terms 2^-127 (double: 2^-1023)
// below the largest are left out; rounding is 2^-24 (2^-53).
//
// Cells: state s of component k lies in cell s * stride + k; arrays of cells
// are padded as ScaledModel says, to kBlock cells and aligned to 64 bytes.
// Patterns hold one number a component, repeated to fill a vector: [period], at
// least kPattern.
//
// Thread-safe: free functions on the caller's buffers; they allocate nothing.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tactus {

// Cells evaluated together at most; parameters are interleaved by it.
inline constexpr int kBlock = 16;

template <typename T>
inline constexpr int kPattern = 64 / sizeof(T);

template <typename T>
struct Scaled;
template <>
struct Scaled<float> {
  // Exponent of a share that is zero; sums of a few of them are finite.
  static constexpr float kNothing = -1e36F;
  // Ceiling of the squared distance, in bits; what is not finite takes it too.
  static constexpr float kFarthest = 1e34F;
  // A frame that leaves no share above 2 to that has cost digits.
  static constexpr float kTrusted = -0x1p20F;
};
template <>
struct Scaled<double> {
  static constexpr double kNothing = -1e304;
  // 1e7 frames of it still sum to a finite log-likelihood.
  static constexpr double kFarthest = 1e300;
  static constexpr double kTrusted = -0x1p40;
};

// Shares of cells: mantissa and exponent, [cells] and padding either side.
template <typename T>
struct Shares {
  T* mantissa;
  T* exponent;
};

// to[j] = sum (best: largest) over i of from[i] transition[i][j]; mantissas of
// `to` are in [1, 2). `from` and `to` do not overlap.
template <typename T>
struct PredictStep {
  bool best;
  int cells;   // in use
  int stride;  // cells from one state to the next
  // Transitions from i to j lead `first_jump` <= j - i < first_jump + jumps.
  int first_jump;
  int jumps;
  const T* transitions;  // [cells / kBlock][jumps][2][kBlock]
  Shares<T> from;
  Shares<T> to;
};
void Predict(const PredictStep<float>& step);
void Predict(const PredictStep<double>& step);

// to[j] = from[j] times the density of state j at x, over 2^lowered of its
// component; finds the largest exponent of each pattern entry. `to` may be
// `from`.
template <typename T>
struct WeighStep {
  int cells;
  int stride;
  int period;
  int dimensions;
  bool full;           // the inverse factors are triangular, not diagonal
  const T* emissions;  // [cells / kBlock][rows][kBlock], see ScaledModel
  // float: one observation for all, rounded, then what rounding left, [2 D];
  // double: one for each component, patterns [D][period].
  const T* x;
  const T* lowered;     // [period]
  T* largest_exponent;  // [period]
  Shares<T> from;
  Shares<T> to;
};
void Weigh(const WeighStep<float>& step);
void Weigh(const WeighStep<double>& step);

// Predicts and weighs at once, as a frame asks for, with lowered = 0 and
// without keeping the prediction: predict.to, weigh.from and weigh.lowered are
// not used. False if a component's largest exponent is not between kTrusted and
// -kTrusted.
template <typename T>
struct AdvanceStep {
  PredictStep<T> predict;
  WeighStep<T> weigh;
};
bool Advance(const AdvanceStep<float>& step);
bool Advance(const AdvanceStep<double>& step);

// Over the states of each component, by pattern entry.
template <typename T>
struct Reduction {
  bool best;
  int cells;
  int period;
  Shares<T> shares;
  T* largest_exponent;  // [period]
  T* total;             // [period]
};
// Writes largest_exponent.
void FindLargest(const Reduction<float>& step);
void FindLargest(const Reduction<double>& step);
// Writes total: the sum (best: largest) of the shares, over
// 2^largest_exponent, which is read.
void Total(const Reduction<float>& step);
void Total(const Reduction<double>& step);

// The instruction set in use, such as "AVX3".
const char* KernelTarget();

}  // namespace tactus
