// File: scaled_kernels.h
//
// The forward algorithm and Viterbi for many HMMs side by side, vectorised for
// every CPU with run-time dispatch (Highway). Used through ScaledModel and
// ScaledFilter.
//
// The share of a state is its forward variable (Viterbi: that of the best path
// to it). It is stored as mantissa * 2^exponent; the exponent is a whole number
// in the same floating-point type. So no share underflows, a state may recover
// from any distance, and a frame needs no logarithm and only the exponential of
// a fraction of a bit. Sums leave out terms that are 2^-127 (double: 2^-1023)
// of the largest; the rounding error is 2^-24 (2^-53).
//
// Cells: state s of component k lies in cell s * stride + k. Arrays of cells
// are padded to kBlock cells as ScaledModel describes, and aligned to 64 bytes.
// Patterns hold one number per component, repeated to fill a vector: [period],
// at least kPattern.
//
// Thread-safe: free functions on the caller's buffers; they allocate nothing.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tactus::internal {

// Largest number of cells evaluated together. Parameters are interleaved in
// blocks of this size.
inline constexpr int kBlock = 16;

template <typename T>
inline constexpr int kPattern = 64 / sizeof(T);

template <typename T>
struct Scaled;
template <>
struct Scaled<float> {
  // Exponent of a share of zero. Sums of a few of them are finite.
  static constexpr float kNothing = -1e36F;
  // Largest squared distance, in bits. Also used for what is not finite.
  static constexpr float kFarthest = 1e34F;
  // If a frame leaves no share above 2 to the power of this, digits are lost.
  static constexpr float kTrusted = -0x1p20F;
};
template <>
struct Scaled<double> {
  static constexpr double kNothing = -1e304;
  // 1e7 frames at this distance still have a finite log-likelihood.
  static constexpr double kFarthest = 1e300;
  static constexpr double kTrusted = -0x1p40;
};

// Shares of cells: mantissa and exponent, [cells] with padding on both sides.
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

// to[j] = from[j] times the density of state j at x, divided by 2^lowered of
// its component. Finds the largest exponent of each pattern entry. `to` may be
// `from`.
template <typename T>
struct WeighStep {
  int cells;
  int stride;
  int period;
  int dimensions;
  bool full;           // the inverse factors are triangular, not diagonal
  const T* emissions;  // [cells / kBlock][rows][kBlock], see ScaledModel
  // float: one observation for all components, [2 D]: rounded values, then the
  // rounding errors. double: one per component, patterns [D][period].
  const T* x;
  const T* lowered;     // [period]
  T* largest_exponent;  // [period]
  Shares<T> from;
  Shares<T> to;
};
void Weigh(const WeighStep<float>& step);
void Weigh(const WeighStep<double>& step);

// Predicts and weighs one frame at once, with lowered = 0 and without storing
// the prediction: predict.to, weigh.from and weigh.lowered are not used.
// Returns false if a component's largest exponent is not between kTrusted and
// -kTrusted.
template <typename T>
struct AdvanceStep {
  PredictStep<T> predict;
  WeighStep<T> weigh;
};
bool Advance(const AdvanceStep<float>& step);
bool Advance(const AdvanceStep<double>& step);

// A reduction over the states of each component, per pattern entry.
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
// Writes total: the sum (best: largest) of the shares, divided by
// 2^largest_exponent, which is an input.
void Total(const Reduction<float>& step);
void Total(const Reduction<double>& step);

}  // namespace tactus::internal
