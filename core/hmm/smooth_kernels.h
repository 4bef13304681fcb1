// File: smooth_kernels.h
//
// The backward half of Baum-Welch, vectorised like scaled_kernels.h, whose
// cells it shares: one model, up to 8 sequences side by side in place of
// components. Used by ForwardBackward. A plane is an array of cells, rounded up
// to whole blocks; patterns are [kPattern].
//
// Thread-safe: free functions on the caller's buffers; they allocate nothing.
#pragma once

#include <cstddef>

#include "core/hmm/scaled_kernels.h"

namespace tactus {

// One step back in time. With i's belief at t (predict.from),
//   taken[i][j] = belief[i] transition[i][j] / sum over k of
//                 belief[k] transition[k][j], times share_next[j];
// share[i] becomes the sum over j, flushed to 0 below 1e-30. predict.best and
// predict.to are not used.
struct SmoothStep {
  PredictStep<double> predict;
  const double* share_next;
  // By jump q and the state that is entered, [jumps] arrays of cells, the first
  // cells `pitch` apart.
  size_t pitch;
  double* taken_now;  // padding either side is 0
  double* taken;      // added to
  double* share;      // may be predict.from.mantissa
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

// Adds frames whose states are distributed as `share` to the moments about the
// means: planes for occupancy, then per dimension a the first moment and the
// second ones (a, 0) .. (a, a), without full covariances (a, a) alone.
struct MomentStep {
  int cells;
  int dimensions;
  bool full;
  int frames;
  const double* x;      // patterns, [frames][D][kPattern]
  const double* share;  // of the first frame
  size_t share_pitch;   // from a frame's to the next
  size_t plane;         // cells of one
  const double* means;  // [D][plane]
  double* moments;
};
void AddMoments(const MomentStep& step);

}  // namespace tactus
