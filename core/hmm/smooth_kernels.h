// File: smooth_kernels.h
//
// The backward half of Baum-Welch, vectorised like scaled_kernels.h, whose
// cells it shares: one model, up to 8 sequences side by side in place of
// components. Used by Expectation. A plane is an array of cells, rounded up to
// whole blocks, without padding either side; patterns are [kPattern].
//
// Thread-safe: free functions on the caller's buffers; they allocate nothing.
#pragma once

#include <cstddef>

#include "core/hmm/scaled_kernels.h"

namespace tactus {

// One step back in time. With i's belief at t and j's prediction for t + 1,
//   taken[i][j] = belief[i] transition[i][j] / predicted[j] share_next[j];
// share[i] becomes the sum over j, flushed to 0 below 1e-30.
struct SmoothStep {
  int cells;
  int stride;
  int first_jump;
  int jumps;
  size_t plane;  // cells of one, a multiple of kBlock
  // Transitions by the state that is left, [jumps][plane] each.
  const double* mantissa;
  const double* exponent;
  Shares<double> belief;
  Shares<double> predicted;
  const double* share_next;
  double* quotient;  // scratch; padding either side is 0
  double* share;
  double* taken;  // [jumps][plane], added to
};
void Smooth(const SmoothStep& step);

// share[j] = shares[j] / total / 2^largest, exactly 0 where a share is nothing.
struct NormaliseStep {
  int cells;
  Shares<double> shares;
  const double* total;             // pattern
  const double* largest_exponent;  // pattern
  double* share;
};
void Normalise(const NormaliseStep& step);

// Adds a frame whose state is distributed as `share` to the moments about the
// means: planes for occupancy, then per dimension a the first moment and the
// second ones (a, 0) .. (a, a), without full covariances (a, a) alone.
struct MomentStep {
  int cells;
  int dimensions;
  bool full;
  size_t plane;
  const double* means;  // [D][plane]
  const double* x;      // patterns, [D][kPattern]
  const double* share;
  double* moments;
};
void AddMoments(const MomentStep& step);

}  // namespace tactus
