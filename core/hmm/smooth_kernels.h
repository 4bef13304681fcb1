// File: smooth_kernels.h
//
// The backward half of Baum-Welch. It is vectorised like scaled_kernels.h and
// uses the same cells, but for one model: up to 8 sequences take the place of
// the components. ForwardBackward uses it. A plane is an array of cells,
// rounded up to whole blocks; patterns are [kPattern].
//
// Thread-safe: free functions on the caller's buffers; they allocate nothing.
#pragma once

#include <cstddef>

#include "core/hmm/scaled_kernels.h"

namespace tactus::internal {

// One step back in time. With i's belief at t (predict.from),
//   taken[i][j] = belief[i] transition[i][j] / sum over k of
//                 belief[k] transition[k][j], times share_next[j];
// share[i] becomes the sum over j, and 0 if that is below 1e-30. predict.best
// and predict.to are not used.
struct SmoothStep {
  PredictStep<double> predict;
  const double* share_next;
  // [jumps] arrays of cells, by the state that is entered. Their first cells
  // are `pitch` apart.
  size_t pitch;
  double* taken_now;  // the padding on both sides is 0
  double* taken;      // added to
  double* share;      // may be predict.from.mantissa
};
void Smooth(const SmoothStep& step);

// share[j] = shares[j] / total / 2^largest, exactly 0 for a share of zero.
struct NormaliseStep {
  int cells;
  Shares<double> shares;
  const double* total;             // pattern
  const double* largest_exponent;  // pattern
  double* share;
};
void Normalise(const NormaliseStep& step);

// Adds frames to the moments about the means; `share` is the distribution of
// their states. The planes are: occupancy, then per dimension a the first
// moment and the second moments (a, 0) .. (a, a), or only (a, a) without full
// covariances.
struct MomentStep {
  int cells;
  int dimensions;
  bool full;
  int frames;
  const double* x;      // patterns, [frames][D][kPattern]
  const double* share;  // of the first frame
  size_t share_pitch;   // from one frame to the next
  size_t plane;         // cells per plane
  const double* means;  // [D][plane]
  double* moments;
};
void AddMoments(const MomentStep& step);

}  // namespace tactus::internal
