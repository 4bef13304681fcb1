// File: packed_matrix.h
//
// A weight matrix laid out for the kernels in both directions, and the
// gradient by it.
//
//   PackedMatrix matrix(200, 50);
//   matrix.SetWeights(layer.recurrent);
//
// Not thread-safe.
#pragma once

#include <algorithm>
#include <vector>

#include "core/lstm/kernels.h"

namespace tactus {

struct PackedMatrix {
  PackedMatrix() = default;
  PackedMatrix(int rows, int inputs)
      : rows(rows),
        inputs(inputs),
        forward(inputs * Padded(rows)),
        backward(rows * Padded(inputs)),
        gradient(forward.size()) {}

  // `weights` and `result` are rows x inputs, row-major, without padding.
  void SetWeights(const std::vector<float>& weights) {
    for (int r = 0; r < rows; ++r) {
      const float* row = &weights[r * inputs];
      std::copy_n(row, inputs, &backward[r * Padded(inputs)]);
      for (int k = 0; k < inputs; ++k) forward[k * Padded(rows) + r] = row[k];
    }
  }
  void GetGradient(std::vector<float>& result) const {
    for (int r = 0; r < rows; ++r) {
      float* row = &result[r * inputs];
      for (int k = 0; k < inputs; ++k) row[k] = gradient[k * Padded(rows) + r];
    }
  }

  int rows = 0;
  int inputs = 0;
  LstmBuffer forward;   // inputs x Padded(rows)
  LstmBuffer backward;  // rows x Padded(inputs)
  LstmBuffer gradient;  // as forward
};

}  // namespace tactus
