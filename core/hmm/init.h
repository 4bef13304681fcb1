// File: init.h
//
// The initial model of training, as in the paper (Section "Implementation"): a
// uniform prior over the states, means and deviations from the data, a
// spherical covariance.
//
//   TACTUS_ASSIGN_OR_RETURN(GaussianHmm model, InitPaper(sequences, options));
//
// The paper does not say which data. Here every sequence is cut into N pieces
// of equal length, and state n gets the mean and deviation of all n-th pieces.
//
// Thread-safe: a free function, deterministic.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/hmm/gaussian_hmm.h"
#include "core/hmm/sequence.h"

namespace tactus::internal {

struct InitOptions {
  int states = 10;  // N
  // Left-right: from a state only later states are reached. Otherwise ergodic:
  // every state is reached from every state.
  bool left_right = true;
  // Left-right only: the longest step. 1: to the next state; 2: may leave out
  // one state; N - 1: the full upper triangle.
  int max_jump = 1;
  CovarianceType covariance_type = CovarianceType::kFull;
  double covariance_floor = 1e-4;  // smallest variance, above 0
};

// The probability of staying in a state is that of a mean duration of T / N
// frames, where T is the mean length of the sequences, and at least 0.5. The
// other transitions have equal probabilities.
// Fails with INVALID_TRAINING_DATA or INVALID_CONFIG.
absl::StatusOr<GaussianHmm> InitPaper(
    const std::vector<SequenceView>& sequences, const InitOptions& options);

}  // namespace tactus::internal
