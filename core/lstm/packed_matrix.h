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

namespace tactus::internal {

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
      std::copy_n(&weights[r * inputs], inputs, &backward[r * Padded(inputs)]);
    }
    ForEachTile([&](int r, int k) {
      forward[k * Padded(rows) + r] = weights[r * inputs + k];
    });
  }
  void GetGradient(std::vector<float>& result) const {
    ForEachTile([&](int r, int k) {
      result[r * inputs + k] = gradient[k * Padded(rows) + r];
    });
  }

  // Calls visit(row, input) for each weight, in tiles that fit the first-level
  // cache whichever of the two is contiguous.
  template <typename Visit>
  void ForEachTile(Visit visit) const {
    constexpr int kTile = 16;
    for (int r0 = 0; r0 < rows; r0 += kTile) {
      const int r1 = std::min(rows, r0 + kTile);
      for (int k = 0; k < inputs; ++k) {
        for (int r = r0; r < r1; ++r) visit(r, k);
      }
    }
  }

  int rows = 0;
  int inputs = 0;
  LstmBuffer forward;   // inputs x Padded(rows)
  LstmBuffer backward;  // rows x Padded(inputs)
  LstmBuffer gradient;  // as forward
};

}  // namespace tactus::internal
