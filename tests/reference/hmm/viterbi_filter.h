// File: viterbi_filter.h
//
// The incremental Viterbi algorithm of one HMM in the log domain: the score of
// the best state path, which is the paper's score. The tests compare
// core/hmm/hmm_bank.h with it.
//
//   ViterbiFilter filter(hmm);
//   filter.Step(observation);      // per frame
//   filter.score();                // log of the best path's probability
//
// Not thread-safe: one filter per stream. Refers to the CompiledHmm, which must
// outlive it. Step, Skip and Reset allocate nothing.
#pragma once

#include <span>
#include <vector>

#include "tests/reference/hmm/compiled_hmm.h"
#include "tests/reference/hmm/recursion.h"

namespace tactus::internal {

class ViterbiFilter {
 public:
  explicit ViterbiFilter(const CompiledHmm& hmm);

  // As for ForwardFilter. For lost frames, the path is chosen and their values
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

}  // namespace tactus::internal
