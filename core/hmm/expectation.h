// File: expectation.h
//
// The expectation step of Baum-Welch over training sequences: their expected
// counts, see forward_backward.h.
//
//   Expectation expectation(sequences);
//   const ExpectedCounts counts = expectation.Compute(model);
//
// The sequences are taken in side by side, so that short models fill vectors
// too.
//
// Not thread-safe. Copies the sequences; buffers are kept between models.
#pragma once

#include <vector>

#include "core/hmm/forward_backward.h"
#include "core/hmm/gaussian_hmm.h"
#include "core/hmm/sequence.h"
#include "core/hmm/sequence_batch.h"

namespace tactus {

class Expectation {
 public:
  // sequences: valid.
  explicit Expectation(const std::vector<SequenceView>& sequences);

  // model: valid, of the sequences' dimensions.
  ExpectedCounts Compute(const GaussianHmm& model, Sums sums = Sums::kAll);

 private:
  std::vector<SequenceBatch> batches_;
  std::vector<ForwardBackward> smoothers_;  // one for each number of lanes
};

}  // namespace tactus
