// File: init.h
//
// The model training starts from, as in the paper (Section "Implementation"):
// a uniform prior over the states, means and deviations from the data, a
// spherical covariance.
//
//   TACTUS_ASSIGN_OR_RETURN(GaussianHmm model, InitPaper(sequences, options));
//
// Where the paper is silent: every sequence is cut into N pieces of equal
// length and state n takes the mean and deviation of all n-th pieces.
//
// Thread-safe: a free function, deterministic.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/hmm/gaussian_hmm.h"
#include "core/hmm/sequence.h"

namespace tactus {

struct InitOptions {
  int states = 10;  // N
  // Left-right: a state stays or steps on; ergodic: it may go anywhere.
  bool left_right = true;
  // Left-right only: the furthest step; 1 = next state, 2 = may leave one
  // out, N - 1 = the full upper triangle.
  int max_jump = 1;
  CovarianceType covariance_type = CovarianceType::kFull;
  double covariance_floor = 1e-4;  // smallest variance, above 0
};

// The probability of staying is that of states that last T / N frames, T the
// mean length of the sequences, at least 0.5; the rest is spread evenly.
// Fails with INVALID_TRAINING_DATA or INVALID_CONFIG.
absl::StatusOr<GaussianHmm> InitPaper(
    const std::vector<SequenceView>& sequences, const InitOptions& options);

}  // namespace tactus
