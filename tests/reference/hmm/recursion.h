// File: recursion.h
//
// The two halves of one step of the forward algorithm (Rabiner 1989, equations
// 19 to 21, scaled) of the log-domain filters.
//
// Beliefs are carried twice: as probabilities, which makes the sums cheap, and
// as logarithms, which never underflow. A sum of probabilities that has become
// too small to be trusted is redone with the logarithms. So a state that is
// 1e5 nats behind keeps its exact share and can win again, as in the exact
// algorithm, and the forward log-likelihood is never below the Viterbi score.
//
// Thread-safe: free functions. They allocate nothing.
#pragma once

#include "tests/reference/hmm/compiled_hmm.h"

namespace tactus::internal {

// Sums of probabilities above this have lost nothing to underflow: what a
// belief drops is below 1e-299.
inline constexpr double kTrustedSum = 1e-280;
// Terms this far below the largest of a sum are beneath its rounding.
inline constexpr double kNegligibleExponent = -50;

// A distribution over states; both members have [N] entries, owned elsewhere.
struct Belief {
  double* probability;
  double* log_probability;
};

// predicted[j] = sum_i belief[i] transition[i][j]. `belief` sums to 1.
void Predict(const CompiledHmm& hmm, const Belief& belief,
             const Belief& predicted);

// belief[j] = predicted[j] exp(log_density[j]) / Z; returns log Z, the
// log-likelihood of the frame given the frames before it.
// log_density: [N], every entry finite.
double Update(const CompiledHmm& hmm, const Belief& predicted,
              const double* log_density, const Belief& belief);

// Adds up doubles as if with twice the precision (Neumaier, ZAMM 1974): a
// stream's log-likelihood stays exact over 1e7 frames and past outliers.
class CompensatedSum {
 public:
  void Add(double value);
  double value() const { return sum_ + rest_; }

 private:
  double sum_ = 0;
  double rest_ = 0;
};

}  // namespace tactus::internal
