// File: expectation.h
//
// The expectation step of Baum-Welch: how often, given the observations, each
// state was visited and each transition taken, and what was seen there
// (Rabiner 1989, equations 27, 37 and 38).
//
//   Expectation expectation;
//   expectation.Reset(model);
//   for (const SequenceView& s : sequences) expectation.Add(hmm, s);
//
// The backward pass smooths the filtered beliefs,
//   p(i at t | j at t+1, o_1 .. o_t) = belief_t[i] transition[i][j]
//                                      / predicted_t+1[j],
// which is the textbook backward variable in a form whose every number is a
// probability and which evaluates no density twice.
//
// Not thread-safe. Buffers grow to the longest sequence and are kept.
#pragma once

#include <cstddef>
#include <vector>

#include "core/hmm/compiled_hmm.h"
#include "core/hmm/gaussian_hmm.h"
#include "core/hmm/sequence.h"

namespace tactus {

class Expectation {
 public:
  // Forgets all sequences. Moments are taken about the means of `model`.
  void Reset(const GaussianHmm& model);

  // Takes in one sequence. `hmm` is compiled from the model given to Reset.
  void Add(const CompiledHmm& hmm, const SequenceView& sequence);

  // Sum over sequences of log p(sequence).
  double log_likelihood() const { return log_likelihood_; }
  // Expected number of sequences that start in each state, [N].
  const std::vector<double>& starts() const { return starts_; }
  // Expected number of transitions from i to j at [i * N + j], [N x N].
  const std::vector<double>& transitions() const { return transitions_; }
  // Expected number of frames spent in each state, [N].
  const std::vector<double>& occupancy() const { return occupancy_; }
  // Expected sum of x - mean per state, [N x D].
  const std::vector<double>& first_moment() const { return first_; }
  // Expected sum of (x - mean)(x - mean)' per state, [N x D x D]; only the
  // lower triangle is kept, without full covariances only the diagonal.
  const std::vector<double>& second_moment() const { return second_; }

 private:
  void Forward(const CompiledHmm& hmm, const SequenceView& sequence);
  void Backward(const CompiledHmm& hmm, const SequenceView& sequence);
  // Adds a frame whose state is distributed as `share` [N].
  void AddFrame(const double* share, const double* frame);

  int states_ = 0;
  int dimensions_ = 0;
  bool full_ = false;
  std::vector<double> means_;
  double log_likelihood_ = 0;
  std::vector<double> starts_, transitions_, occupancy_, first_, second_;
  // Per frame of the current sequence, [T x N] each.
  std::vector<double> belief_, log_belief_, predicted_, log_predicted_;
  std::vector<double> log_density_, share_, next_share_;  // [N]
  std::vector<double> difference_;                        // [D]
};

}  // namespace tactus
