// File: forward_backward.h
//
// The forward-backward algorithm for batches of sequences. Given the
// observations, it computes the expected number of visits of each state, of
// uses of each transition, and the moments of the observations in each state
// (Rabiner 1989, equations 27, 37 and 38).
//
//   ForwardBackward smoother(batch.lanes());
//   smoother.SetModel(model);
//   smoother.Add(batch, Counts::kAll);
//   smoother.AddTo(counts);
//
// The backward pass smooths the filtered beliefs,
//   p(i at t | j at t+1, o_1 .. o_t) = belief_t[i] transition[i][j]
//                                      / predicted_t+1[j],
// This is equivalent to the textbook backward variable, but every number is a
// probability and no density is evaluated twice. Scaled in double
// (scaled_kernels.h), so no state underflows.
//
// Not thread-safe. Buffers grow to the longest batch and are reused.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/hmm/gaussian_hmm.h"
#include "core/hmm/scaled_model.h"
#include "core/hmm/sequence_batch.h"

namespace tactus::internal {

// Expected counts, summed over sequences.
struct ExpectedCounts {
  explicit ExpectedCounts(int states, int dimensions)
      : starts(states),
        transitions(static_cast<size_t>(states) * states),
        occupancy(states),
        first_moment(static_cast<size_t>(states) * dimensions),
        second_moment(first_moment.size() * dimensions) {}

  // Sum of log p(sequence).
  double log_likelihood = 0;
  // Expected number of sequences that start in each state, [N].
  std::vector<double> starts;
  // Expected number of transitions from i to j at [i * N + j], [N x N].
  std::vector<double> transitions;
  // Expected number of frames spent in each state, [N].
  std::vector<double> occupancy;
  // Expected sum of x - mean per state, [N x D], about the model's means.
  std::vector<double> first_moment;
  // Expected sum of (x - mean)(x - mean)' per state, [N x D x D]. Only the
  // lower triangle is filled; for models without full covariances only the
  // diagonal.
  std::vector<double> second_moment;
};

// What to compute. The log-likelihood alone costs half as much as all counts.
enum class Counts { kAll, kLogLikelihood };

class ForwardBackward {
 public:
  explicit ForwardBackward(int lanes) : lanes_(lanes) {}

  int lanes() const { return lanes_; }

  // Sets all sums to 0. model: valid; not referred to later.
  void SetModel(const GaussianHmm& model);
  // batch: has lanes() lanes and the model's dimensions.
  void Add(const SequenceBatch& batch, Counts wanted);
  void AddTo(ExpectedCounts& counts) const;

 private:
  void Forward(const SequenceBatch& batch);
  void Backward(const SequenceBatch& batch);
  // One frame for which the exponents of the shares must be lowered first.
  void StepLowered(const double* x, int t);
  static bool EndsAt(const SequenceBatch& batch, int t);
  // Finds the largest exponent and the total of each lane's shares at t.
  void Reduce(int t);
  // Adds the log-likelihoods of the lanes that end with frame t.
  void AddLogLikelihoods(const SequenceBatch& batch, int t);
  // For lanes that end with frame t, the smoothed share is the normalised
  // belief.
  void NormaliseBelief(int t);
  void TakeLastShares(const SequenceBatch& batch, int t);
  void AddMoments(const SequenceBatch& batch, int first, int frames);
  // Padded arrays of frame t.
  Shares<double> Belief(int t);
  // Smoothed shares of frame t. They overwrite the mantissas of its belief.
  double* Share(int t) { return Belief(t).mantissa + model_->front(); }
  // Number of planes of moments before those of dimension a.
  int MomentPlanes(int a) const;
  // Sum over the lanes of the cells from `first` on.
  double Sum(const double* first) const;

  const int lanes_;
  std::optional<ScaledModel<double>> model_;  // one component a lane
  size_t plane_ = 0;                          // cells, in whole blocks
  AlignedVector<double> means_;               // [D][plane]
  // Sums, by lane.
  double log_likelihood_ = 0;
  AlignedVector<double> starts_;   // [plane]
  AlignedVector<double> taken_;    // [jumps][padded], by the state entered
  AlignedVector<double> moments_;  // as tactus::internal::AddMoments keeps them
  // Mantissas and exponents of each frame of the batch, [T][2][padded].
  AlignedVector<double> frames_;
  AlignedVector<double> cleared_;  // a frame whose shares are all zero
  // Bits by which each lane's shares were lowered: whole numbers, so the sum is
  // exact.
  std::vector<double> taken_out_;
  AlignedVector<double> lowered_, largest_, total_;  // patterns
  AlignedVector<double> predicted_;                  // [2][padded]
  AlignedVector<double> taken_now_;                  // [jumps][padded]
  AlignedVector<double> last_share_;                 // [plane]
};

}  // namespace tactus::internal
