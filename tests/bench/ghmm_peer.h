// File: ghmm_peer.h
//
// A GaussianHmm in libghmm, the General Hidden Markov Model library that the
// paper used. Benchmarks time core/hmm against it, and tests compare results
// with it.
//
//   std::unique_ptr<GhmmPeer> peer = MakeGhmmPeer(model);
//   if (peer == nullptr) ...  // libghmm was not installed at build time
//   TACTUS_ASSIGN_OR_RETURN(double log_likelihood, peer->LogLikelihood(x));
//
// Not thread-safe: libghmm keeps global state.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/hmm/gaussian_hmm.h"
#include "core/hmm/sequence.h"

namespace tactus::internal::client {

class GhmmPeer {
 public:
  virtual ~GhmmPeer() = default;

  // Scores of `observations` [frames x D], in nats; libghmm only reads them.
  // The errors are libghmm's: it refuses frames that underflow in every state.
  virtual absl::StatusOr<double> LogLikelihood(
      std::span<double> observations) = 0;
  virtual absl::StatusOr<double> ViterbiScore(
      std::span<double> observations) = 0;

  // Updates the model in place by Baum-Welch, `iterations` times or until an
  // update gains nothing. libghmm computes moments about the old means.
  virtual absl::Status Train(const std::vector<SequenceView>& sequences,
                             int iterations) = 0;

  virtual GaussianHmm model() const = 0;
};

// Null without libghmm.
std::unique_ptr<GhmmPeer> MakeGhmmPeer(const GaussianHmm& model);

}  // namespace tactus::internal::client
