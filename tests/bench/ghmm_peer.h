// File: ghmm_peer.h
//
// A GaussianHmm in libghmm, the General Hidden Markov Model library, which the
// paper used: the peer that core/hmm is timed against, and the independent
// reference of its tests.
//
//   std::unique_ptr<GhmmPeer> peer = MakeGhmmPeer(model);
//   if (peer == nullptr) ...  // libghmm was not there at build time
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

namespace tactus::client {

class GhmmPeer {
 public:
  virtual ~GhmmPeer() = default;

  // Of `observations` [frames x D], which libghmm only reads, in nats. Errors
  // are libghmm's: it refuses what underflows in every state.
  virtual absl::StatusOr<double> LogLikelihood(
      std::span<double> observations) = 0;
  virtual absl::StatusOr<double> ViterbiScore(
      std::span<double> observations) = 0;

  // Baum-Welch updates of the model in place, `iterations` of them or fewer
  // when one gains nothing. libghmm takes moments about the old means.
  virtual absl::Status Train(const std::vector<SequenceView>& sequences,
                             int iterations) = 0;

  virtual GaussianHmm model() const = 0;
};

// Null without libghmm.
std::unique_ptr<GhmmPeer> MakeGhmmPeer(const GaussianHmm& model);

}  // namespace tactus::client
