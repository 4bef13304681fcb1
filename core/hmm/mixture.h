// File: mixture.h
//
// A category modelled by several HMMs: log p(o | category) =
// log sum_k weight_k p(o | hmm_k). One component is the paper's model; several
// are clusters of trials (train_mixture.h).
//
// HmmBank scores the mixtures of all categories.
//
//   HmmMixture mixture = {.log_weight = {0}, .components = {model}};
//   TACTUS_RETURN_IF_ERROR(Validate(mixture));
//
// Thread-safe while nobody writes to it, like any plain data.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "core/hmm/gaussian_hmm.h"

namespace tactus {

// K components of equal dimensions; plain data.
struct HmmMixture {
  std::vector<double> log_weight;       // [K], natural logarithms
  std::vector<GaussianHmm> components;  // [K]
};

// Refuses with INVALID_MODEL: no or too many components, sizes that differ,
// weights that do not sum to 1 within 1e-9 (a weight of 0, log -infinity, is
// refused too), a component that is not valid.
absl::Status Validate(const HmmMixture& mixture);

// What a component's share is: its likelihood summed over state paths, or that
// of its best path, as the paper scored.
enum class Score { kForward = 0, kViterbi = 1 };

}  // namespace tactus
