// File: forward.h
//
// The incremental forward algorithm: one call per frame, constant memory, a
// running log-likelihood (Rabiner 1989, equations 19 to 21). Use it to score
// a stream while it arrives; ViterbiFilter is the paper's score.
//
//   ForwardFilter filter(hmm);
//   filter.Step(observation);      // per frame
//   filter.Skip(3);                // three frames were lost
//   filter.log_likelihood();       // log p(o_1 .. o_t)
//
// Numerics: belief is exact down to any distance from the best state (see
// recursion.h). A Gaussian is nowhere zero and its logarithm is held above
// -5e299 (see emission.h), so log_likelihood() is finite for any finite or
// non-finite input and state_posterior() always sums to 1; a non-finite
// observation, refused upstream, costs -5e299 and leaves the belief at the
// prediction. The same observations give the same bits.
//
// Not thread-safe: one per stream. Refers to the CompiledHmm, which must
// outlive it. Step, Skip and Reset allocate nothing.
#pragma once

#include <span>
#include <vector>

#include "core/hmm/compiled_hmm.h"
#include "core/hmm/recursion.h"

namespace tactus {

class ForwardFilter {
 public:
  explicit ForwardFilter(const CompiledHmm& hmm);

  // Forgets all frames.
  void Reset();

  // Takes in the next frame. observation: [D].
  void Step(std::span<const double> observation);

  // Passes over `missing` frames that were lost: the belief moves through the
  // transitions, as if summed over every value they could have had. Costs as
  // much as `missing` steps; none if 0 or less.
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

class ViterbiFilter {
 public:
  explicit ViterbiFilter(const CompiledHmm& hmm);

  // As for ForwardFilter; over lost frames the path is chosen, their values
  // are summed out.
  void Reset();
  void Step(std::span<const double> observation);
  void Skip(int missing);

  // log of the largest p(o_1 .. o_t, path) over all state paths; 0 before the
  // first frame.
  double score() const { return score_.value(); }

  // The state in which that path ends.
  int best_state() const;

 private:
  void PredictNext();

  const CompiledHmm* hmm_;
  // [3 x N]: log probability of the best path to each state, relative to the
  // best of all; the same predicted; log densities.
  std::vector<double> storage_;
  bool started_ = false;
  CompensatedSum score_;
};

}  // namespace tactus
