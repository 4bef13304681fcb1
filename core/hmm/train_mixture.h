// File: train_mixture.h
//
// Trains the mixture of HMMs of one category: trials are grouped by the shape
// of their trajectories, each group gets an HMM by Baum-Welch, and its share
// of the trials is its weight.
//
//   TrainMixtureOptions options;
//   options.components = 10;
//   TACTUS_ASSIGN_OR_RETURN(TrainedMixture trained,
//                           TrainMixture(trials_of_category, options));
//
// Thread-safe: a free function; deterministic given options.baum_welch.seed.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/hmm/baum_welch.h"
#include "core/hmm/mixture.h"
#include "core/hmm/sequence.h"

namespace tactus {

struct TrainMixtureOptions {
  int components = 10;  // K at most; 1 is the paper's model
  int states = 10;      // N of each component
  int max_jump = 1;     // see InitOptions
  // A group with fewer trials is dissolved, its trials join the nearest other.
  int min_trials = 4;
  // Trials are compared by their values at this many moments, evenly spread
  // from first to last frame, each value standardised over the trials.
  int summary_points = 16;
  // After training, trials move to the component that explains them best and
  // the components are trained on; this many times at most.
  int reassignment_rounds = 0;
  BaumWelchOptions baum_welch = {};
};

struct TrainedMixture {
  HmmMixture mixture;
  std::vector<int> component_of;         // [trials]
  std::vector<BaumWelchReport> reports;  // [K], of the last training
};

// Fails as InitPaper and BaumWelch do.
absl::StatusOr<TrainedMixture> TrainMixture(
    const std::vector<SequenceView>& trials,
    const TrainMixtureOptions& options);

}  // namespace tactus
