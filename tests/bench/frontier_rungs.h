// File: frontier_rungs.h
//
// Ways to score all categories' HMMs frame by frame, of different precision.
//
//   TACTUS_ASSIGN_OR_RETURN(auto rung, MakeServedRung(mixtures));
//   rung->Step(observation);
//   rung->Scores(scores);
//
// A rung refers to the mixtures, which must outlive it. One thread at a time.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/hmm/mixture.h"

namespace tactus::client {

// log sum_k exp(values_k).
template <typename T>
T LogSumExp(std::span<const T> values) {
  const T largest = *std::ranges::max_element(values);
  T sum = 0;
  for (const T value : values) sum += std::exp(value - largest);
  return largest + std::log(sum);
}

class Rung {
 public:
  virtual ~Rung() = default;
  virtual void Reset() = 0;
  virtual void Step(std::span<const double> observation) = 0;
  // Log-likelihoods, one per category.
  virtual void Scores(std::span<double> out) = 0;
};

// Scaled in float, as it is served; scaled in double; logarithms in double.
// Fail as Validate(mixture) does.
absl::StatusOr<std::unique_ptr<Rung>> MakeServedRung(
    const std::vector<HmmMixture>& mixtures);
std::unique_ptr<Rung> MakeDoubleRung(const std::vector<HmmMixture>& mixtures);
absl::StatusOr<std::unique_ptr<Rung>> MakeLogarithmRung(
    const std::vector<HmmMixture>& mixtures);

}  // namespace tactus::client
