// File: mixture.h
//
// A class modelled by several HMMs: log p(o | class) =
// log sum_k weight_k p(o | hmm_k). The paper's model has one component. With
// several, each models one cluster of trials (train_mixture.h). HmmBank scores
// the mixtures of all classes.
//
//   HmmMixture mixture = {.log_weight = {0}, .components = {model}};
//   TACTUS_RETURN_IF_ERROR(Validate(mixture));
//
// Plain data; thread-safe while no thread writes to it.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "core/hmm/gaussian_hmm.h"

namespace tactus::internal {

// K components of equal dimensions; plain data.
struct HmmMixture {
  std::vector<double> log_weight;       // [K], natural logarithms
  std::vector<GaussianHmm> components;  // [K]
};

// INVALID_MODEL if there are no or too many components, if sizes differ, if the
// weights do not sum to 1 within 1e-9, if a weight is 0 (its logarithm is
// -infinity), or if a component is not valid.
absl::Status Validate(const HmmMixture& mixture);

// How a component is scored: by its likelihood summed over all state paths, or
// by that of its best path, as in the paper.
enum class Score { kForward = 0, kViterbi = 1 };

}  // namespace tactus::internal
