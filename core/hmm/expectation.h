// File: expectation.h
//
// The expectation step of Baum-Welch: how often, given the observations, each
// state was visited and each transition taken, and what was seen there
// (Rabiner 1989, equations 27, 37 and 38).
//
//   Expectation expectation;
//   expectation.Reset(model);
//   for (const SequenceView& s : sequences) expectation.Add(s);
//
// The backward pass smooths the filtered beliefs,
//   p(i at t | j at t+1, o_1 .. o_t) = belief_t[i] transition[i][j]
//                                      / predicted_t+1[j],
// which is the textbook backward variable in a form whose every number is a
// probability and which evaluates no density twice. Scaled in double
// (scaled_kernels.h): no state is lost, however far behind.
//
// Not thread-safe. Buffers grow to the longest sequence and are kept.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/hmm/gaussian_hmm.h"
#include "core/hmm/scaled_model.h"
#include "core/hmm/sequence.h"

namespace tactus {

class Expectation {
 public:
  // Forgets all sequences. Moments are taken about the means of `model`, which
  // is valid.
  void Reset(const GaussianHmm& model);

  // Takes in one sequence of the model's dimensions.
  void Add(const SequenceView& sequence);

  // Sum over sequences of log p(sequence).
  double log_likelihood() const { return log_likelihood_; }
  // Expected number of sequences that start in each state, [N].
  std::vector<double> starts() const;
  // Expected number of transitions from i to j at [i * N + j], [N x N].
  std::vector<double> transitions() const;
  // Expected number of frames spent in each state, [N].
  std::vector<double> occupancy() const;
  // Expected sum of x - mean per state, [N x D].
  std::vector<double> first_moment() const;
  // Expected sum of (x - mean)(x - mean)' per state, [N x D x D]; only the
  // lower triangle is kept, without full covariances only the diagonal.
  std::vector<double> second_moment() const;

 private:
  void Forward(const SequenceView& sequence);
  void Backward(const SequenceView& sequence);
  // Adds a frame whose state is distributed as share_.
  void AddFrame(const double* frame);
  Shares<double> Belief(int t);
  Shares<double> Predicted(int t);
  // Planes of moments that come before those of dimension a.
  int MomentPlanes(int a) const;

  std::optional<ScaledModel<double>> model_;
  size_t plane_ = 0;             // cells of one, see smooth_kernels.h
  AlignedVector<double> means_;  // [D][plane]
  AlignedVector<double> mantissa_, exponent_;  // transitions, [jumps][plane]
  double log_likelihood_ = 0;
  AlignedVector<double> starts_;   // [plane]
  AlignedVector<double> taken_;    // [jumps][plane]
  AlignedVector<double> moments_;  // as AddMoments keeps them
  // Per frame of the current sequence belief and prediction, each mantissa and
  // exponent: [T x 4 x padded].
  AlignedVector<double> frames_;
  AlignedVector<double> lowered_, largest_, total_;  // [period]
  AlignedVector<double> share_, next_share_;         // [plane]
  AlignedVector<double> quotient_;                   // [padded]
  std::vector<double> x_;                            // [2 D]
};

}  // namespace tactus
