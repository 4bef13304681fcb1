// File: forward_filter.h
//
// The incremental forward algorithm of one HMM in the log domain: one call per
// frame, constant memory, a running log-likelihood (Rabiner 1989, equations 19
// to 21). The tests and benchmarks compare core/hmm/hmm_bank.h with it. It is
// slower than the bank and shares no code with it.
//
//   ForwardFilter filter(hmm);
//   filter.Step(observation);      // per frame
//   filter.Skip(3);                // three frames were lost
//   filter.log_likelihood();       // log p(o_1 .. o_t)
//
// Numerics: the belief is exact for states of any distance from the best state
// (see recursion.h). The logarithm of a Gaussian is at least -5e299 (see
// emission_table.h), so log_likelihood() is finite for any finite or non-finite
// input and state_posterior() always sums to 1. A non-finite observation costs
// -5e299 and leaves the belief at the prediction. The same observations give
// the same bits.
//
// Not thread-safe: one filter per stream. Refers to the CompiledHmm, which must
// outlive it. Step, Skip and Reset allocate nothing.
#pragma once

#include <span>
#include <vector>

#include "tests/reference/hmm/compiled_hmm.h"
#include "tests/reference/hmm/recursion.h"

namespace tactus::internal {

class ForwardFilter {
 public:
  explicit ForwardFilter(const CompiledHmm& hmm);

  // Forgets all frames.
  void Reset();

  // Takes in the next frame. observation: [D].
  void Step(std::span<const double> observation);

  // Passes over `missing` lost frames: the belief moves through the
  // transitions. This equals a sum over all values that the frames could have
  // had. Does nothing if `missing` is 0 or less.
  void Skip(int missing);

  // log p(o_1 .. o_t); 0 before the first frame.
  double log_likelihood() const { return log_likelihood_.value(); }

  // p(state at t | o_1 .. o_t), [N]; the start distribution before the first
  // frame.
  std::span<const double> state_posterior() const {
    return std::span<const double>(storage_).first(hmm_->states());
  }

 private:
  Belief belief();
  Belief predicted();
  void PredictNext();

  const CompiledHmm* hmm_;
  // [5 x N]: belief and prediction (probability, logarithm), log densities.
  std::vector<double> storage_;
  bool started_ = false;
  CompensatedSum log_likelihood_;
};

}  // namespace tactus::internal
