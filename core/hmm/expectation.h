// File: expectation.h
//
// The expectation step of Baum-Welch: how often, given the observations, each
// state was visited and each transition taken, and what was seen there
// (Rabiner 1989, equations 27, 37 and 38).
//
//   Expectation expectation;
//   expectation.Compute(model, sequences);
//   expectation.transitions();
//
// The backward pass smooths the filtered beliefs,
//   p(i at t | j at t+1, o_1 .. o_t) = belief_t[i] transition[i][j]
//                                      / predicted_t+1[j],
// which is the textbook backward variable in a form whose every number is a
// probability and which evaluates no density twice. Scaled in double
// (scaled_kernels.h): no state is lost, however far behind. Several sequences
// are taken in side by side, so that short models fill vectors too.
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
  // What to compute; the log-likelihood costs half as much as all.
  enum class Sums { kAll, kLogLikelihood };

  // Moments are taken about the means of `model`, which is valid. sequences: at
  // least one, of the model's dimensions.
  void Compute(const GaussianHmm& model,
               const std::vector<SequenceView>& sequences,
               Sums sums = Sums::kAll);

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
  // A sequence in the lane of its place in the batch. All of a batch end
  // together; before its first frame a lane holds what counts for nothing.
  struct Lane {
    const SequenceView* sequence;
    int first;  // frame of the batch at which it starts; never: all of them
  };

  void Reset(const GaussianHmm& model, int lanes);
  // batch: in the order of their first frames.
  void AddBatch(const std::vector<Lane>& batch, int frames, Sums sums);
  void Forward(const std::vector<Lane>& batch, int frames);
  void Backward(const std::vector<Lane>& batch, int frames);
  // Frame t of every lane, as the model takes it.
  double* Observation(int t);
  // The lane's first frame is t.
  void Start(int lane, int t);
  // Nothing of a lane counts any more, going back.
  void Leave(int lane);
  Shares<double> Belief(int t);
  Shares<double> Predicted(int t);
  // Planes of moments that come before those of dimension a.
  int MomentPlanes(int a) const;
  // Over the lanes, of a state in one plane.
  double Sum(const AlignedVector<double>& planes, size_t plane,
             size_t state) const;

  std::optional<ScaledModel<double>> model_;  // one component a lane
  size_t plane_ = 0;             // cells of one, see smooth_kernels.h
  AlignedVector<double> means_;  // [D][plane]
  AlignedVector<double> mantissa_, exponent_;  // transitions, [jumps][plane]
  double log_likelihood_ = 0;
  AlignedVector<double> starts_;   // [plane]
  AlignedVector<double> taken_;    // [jumps][plane]
  AlignedVector<double> moments_;  // as AddMoments keeps them
  // Per frame of the batch belief and prediction, each mantissa and exponent:
  // [T x 4 x padded].
  AlignedVector<double> frames_;
  AlignedVector<double> observations_;               // [T][D][kPattern]
  AlignedVector<double> lowered_, largest_, total_;  // patterns
  // Bits taken out of each lane's shares: whole numbers, so the sum is exact.
  std::vector<double> taken_out_;
  AlignedVector<double> share_, next_share_;  // [plane]
  AlignedVector<double> quotient_;            // [padded]
};

}  // namespace tactus
