// File: expectation.h
//
// The expectation step of Baum-Welch: the expected counts of training sequences
// (forward_backward.h).
//
//   Expectation expectation(sequences);
//   const ExpectedCounts counts = expectation.Compute(model);
//
// It processes several sequences side by side, so that models of few states
// fill vector registers too.
//
// Not thread-safe. Copies the sequences; reuses its buffers between models.
#pragma once

#include <vector>

#include "core/hmm/forward_backward.h"
#include "core/hmm/gaussian_hmm.h"
#include "core/hmm/sequence.h"
#include "core/hmm/sequence_batch.h"

namespace tactus::internal {

class Expectation {
 public:
  // sequences: valid.
  explicit Expectation(const std::vector<SequenceView>& sequences);

  // model: valid, with the sequences' dimensions.
  ExpectedCounts Compute(const GaussianHmm& model,
                         Counts wanted = Counts::kAll);

 private:
  std::vector<SequenceBatch> batches_;
  std::vector<ForwardBackward> smoothers_;  // one per number of lanes
};

}  // namespace tactus::internal
