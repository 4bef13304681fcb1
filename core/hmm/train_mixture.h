// File: train_mixture.h
//
// Trains the mixture of HMMs of one class: k-means groups the trials by the
// shape of their trajectories, Baum-Welch trains one HMM per group, and the
// weight of an HMM is the fraction of the trials in its group.
//
//   TrainMixtureOptions options;
//   options.components = 10;
//   TACTUS_ASSIGN_OR_RETURN(TrainedMixture trained,
//                           TrainMixture(trials_of_class, options));
//
// Thread-safe: a free function; deterministic given options.baum_welch.seed.
#pragma once

#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/work.h"
#include "core/hmm/baum_welch.h"
#include "core/hmm/mixture.h"
#include "core/hmm/sequence.h"

namespace tactus::internal {

struct TrainMixtureOptions {
  int components = 10;  // K at most; 1 is the paper's model
  int states = 10;      // N of each component
  int max_jump = 1;     // see InitOptions
  // A group with fewer trials is dissolved: its trials join the nearest group.
  int min_trials = 4;
  // Trials are compared by their values at this many instants, evenly spaced
  // from the first to the last frame. Each value is standardised over the
  // trials.
  int summary_points = 16;
  BaumWelchOptions baum_welch = {};
};

struct TrainedMixture {
  HmmMixture mixture;
  std::vector<int> component_of;         // [trials]
  std::vector<BaumWelchReport> reports;  // [K]
};

// As BaumWelchSink, with the number of the component, from 0.
using MixtureSink =
    absl::FunctionRef<absl::Status(int component, const BaumWelchReport&)>;

inline absl::Status IgnoreComponent(int, const BaumWelchReport&) {
  return absl::OkStatus();
}

// Fails as InitPaper and BaumWelch do.
absl::StatusOr<TrainedMixture> TrainMixture(
    const std::vector<SequenceView>& trials, const TrainMixtureOptions& options,
    MixtureSink on_iteration = IgnoreComponent,
    const ParallelFor& parallel = RunSerially);

}  // namespace tactus::internal
