// File: hmm_scorers.h
//
// Ways to score the HMMs of all classes frame by frame, in different
// precisions: scaled in float as served, scaled in double, logarithms in
// double, and without states of little weight.
//
//   TACTUS_ASSIGN_OR_RETURN(auto scorer, MakeServedScorer(mixtures));
//   scorer->Step(observation);
//   scorer->Scores(scores);
//
// A scorer refers to the mixtures, which must outlive it. Not thread-safe: one
// thread per scorer.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/hmm/mixture.h"

namespace tactus::internal::client {

// log sum_k exp(values_k).
template <typename T>
T LogSumExp(std::span<const T> values) {
  const T largest = *std::ranges::max_element(values);
  T sum = 0;
  for (const T value : values) sum += std::exp(value - largest);
  return largest + std::log(sum);
}

class HmmScorer {
 public:
  virtual ~HmmScorer() = default;
  virtual void Reset() = 0;
  virtual void Step(std::span<const double> observation) = 0;
  // Writes one log-likelihood per class.
  virtual void Scores(std::span<double> out) = 0;
};

// Scaled in float, as served. Fails as Validate(mixture) does.
absl::StatusOr<std::unique_ptr<HmmScorer>> MakeServedScorer(
    const std::vector<HmmMixture>& mixtures);

// Scaled in double. mixtures: valid.
std::unique_ptr<HmmScorer> MakeDoubleScorer(
    const std::vector<HmmMixture>& mixtures);

// Logarithms in double. Fails as Validate(mixture) does.
absl::StatusOr<std::unique_ptr<HmmScorer>> MakeLogarithmScorer(
    const std::vector<HmmMixture>& mixtures);

// Scaled in double, without states of little weight. After each frame, the
// scorer drops the states that hold at most a fraction `bound` of their
// class's forward mass. A dropped state returns when a transition from a
// kept state leads to it. A bound of 0 drops the states whose mass underflows.
// The server keeps all states (docs/skipping.md). mixtures: valid.
std::unique_ptr<HmmScorer> MakePrunedScorer(
    const std::vector<HmmMixture>& mixtures, double bound);

}  // namespace tactus::internal::client
