// File: baum_welch.h
//
// Baum-Welch over many sequences (Rabiner 1989, Sections III.C and V.B):
// expectation maximisation from a given model. Zero transitions and zero
// starts of that model stay zero, which is how it fixes the topology.
//
//   GaussianHmm model = *InitPaper(sequences, init_options);
//   TACTUS_ASSIGN_OR_RETURN(BaumWelchReport report,
//                           BaumWelch(sequences, options, model));
//
// Thread-safe: a free function; deterministic, same input, same bits.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/hmm/gaussian_hmm.h"
#include "core/hmm/sequence.h"

namespace tactus::internal {

struct BaumWelchOptions {
  int max_iterations = 30;  // updates of the model, 0 or more
  // Converged once an update gains less log-likelihood per frame, in nats.
  double tolerance = 1e-4;
  // Smallest eigenvalue (full) or variance (diagonal, spherical) of any
  // covariance, in squared units of the observations; above 0. Full
  // covariances are further kept above 1e-10 of their largest eigenvalue.
  double covariance_floor = 1e-4;
  // The model is converted to this form first.
  CovarianceType covariance_type = CovarianceType::kFull;
  // States follow time: transitions to earlier states are removed first, and
  // a dead state is re-seeded with a frame from its place in time.
  bool left_right = true;
  bool update_start = true;
  // Frames counted in advance for every allowed transition (Dirichlet prior
  // with parameter 1 + transition_prior); 0 is maximum likelihood.
  double transition_prior = 0;
  uint64_t seed = 1;  // for re-seeding only
};

struct BaumWelchReport {
  int iterations = 0;  // updates made
  // Before each update and, last, of the model returned; summed over
  // sequences. [iterations + 1]
  std::vector<double> log_likelihood;
  // States that explained next to nothing and were given a frame of the data
  // as their mean, counted each time.
  int reseeded_states = 0;
  // False if an update lost likelihood (with a prior: posterior density)
  // beyond rounding, other than by the floor or by re-seeding.
  bool monotone = true;
  bool converged = false;
};

// Called with the report so far each time that the model has been scored. An
// error ends the training and is returned.
using BaumWelchSink = absl::FunctionRef<absl::Status(const BaumWelchReport&)>;

inline absl::Status IgnoreIteration(const BaumWelchReport&) {
  return absl::OkStatus();
}

// Improves `model` in place; on error it is left as it was. Fails with
// INVALID_TRAINING_DATA, INVALID_MODEL or INVALID_CONFIG, or as `on_iteration`
// does.
absl::StatusOr<BaumWelchReport> BaumWelch(
    const std::vector<SequenceView>& sequences, const BaumWelchOptions& options,
    GaussianHmm& model, BaumWelchSink on_iteration = IgnoreIteration);

}  // namespace tactus::internal
