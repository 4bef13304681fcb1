// File: kernels.h
//
// The inner loops of LSTM inference and training: matrix products, and one time
// step of the cells of a layer forward and backward. Activations are within
// 2e-7 of the exact ones. The code is compiled for several vector widths. Each
// number results from the same operations in the same order at any width, so
// every CPU gives the same bits.
//
//   LstmBuffer c(5 * Padded(200));
//   BestLstmKernels().product({.rows = 5,
//                              .inner = 50,
//                              .columns = Padded(200),
//                              .a = input,
//                              .a_row = 50,
//                              .b = weights,
//                              .b_row = Padded(200),
//                              .c = c.data(),
//                              .c_row = Padded(200)});
//
// All rows of c, of b and of one number per cell have Padded() entries. The
// padding is finite and has no effect. Kernels read up to kLstmLanes floats
// past the last row of gates.
//
// Owns nothing. Thread-safe: free functions.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/lstm/network.h"

namespace tactus::internal {

// The widest vector, in floats.
inline constexpr int kLstmLanes = 16;

// `count` rounded up to whole vectors.
constexpr int Padded(int count) {
  return (count + kLstmLanes - 1) / kLstmLanes * kLstmLanes;
}

using LstmBuffer = AlignedVector<float>;

// c = start + a b, summed over `inner` in order.
struct LstmProduct {
  int rows = 0;
  int inner = 0;
  int columns = 0;  // a multiple of kLstmLanes
  // a[m, k] lies at a[m * a_row + k * a_column].
  const float* a = nullptr;
  ptrdiff_t a_row = 0;
  ptrdiff_t a_column = 1;
  // inner x columns, rows b_row apart.
  const float* b = nullptr;
  ptrdiff_t b_row = 0;
  // rows x columns, rows start_row apart; 0 repeats one row. May be c itself.
  const float* start = nullptr;
  ptrdiff_t start_row = 0;
  // rows x columns, rows c_row apart.
  float* c = nullptr;
  ptrdiff_t c_row = 0;
};

// The cells of one layer at one time step, for `rows` sequences. Gates lie in
// blocks of `cells`: i, f, c, o.
struct LstmCellShape {
  int rows = 0;
  int cells = 0;
  Activation activation = Activation::kTanh;
  GateActivation gate_activation = GateActivation::kSigmoid;
  ptrdiff_t gate_row = 0;  // distance of sequences in gates and deltas
  ptrdiff_t cell_row = 0;  // and in all else
};

struct LstmCellForward {
  LstmCellShape shape;
  float* gates = nullptr;           // in: sums; out: gates
  const float* previous = nullptr;  // c[t-1]
  float* cell = nullptr;            // out: c[t]; may be `previous` itself
  float* squashed = nullptr;        // out: act(c[t])
  float* output = nullptr;          // out: h[t]
};

// Gradients smaller than 1e-30 become 0. In long sequences they would become
// denormal numbers, which are slow.
struct LstmCellBackward {
  LstmCellShape shape;
  const float* gates = nullptr;
  const float* previous = nullptr;  // c[t-1]
  const float* squashed = nullptr;
  // Gradient of the loss with respect to h[t]: from the layer above and from
  // t+1.
  const float* from_above = nullptr;
  const float* from_next = nullptr;
  // In: gradient with respect to c[t], from t+1. Out: with respect to c[t-1].
  float* carry = nullptr;
  float* deltas = nullptr;  // out: gradient with respect to the gates' sums
};

struct LstmKernels {
  const char* name;
  void (*product)(const LstmProduct&);
  void (*cell_forward)(const LstmCellForward&);
  void (*cell_backward)(const LstmCellBackward&);
};

// The kernels that this CPU can run, narrowest first; never empty.
std::span<const LstmKernels> SupportedLstmKernels();

// The widest kernels that this CPU can run.
const LstmKernels& BestLstmKernels();

}  // namespace tactus::internal
