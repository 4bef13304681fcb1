// File: mixture_weights.h
//
// The weights of a class's HMMs as numbers that sum to 1, as files have them;
// HmmMixture keeps their logarithms.
//
//   const std::vector<double> weights = WeightsOf(mixture);
//   TACTUS_RETURN_IF_ERROR(SetWeights(weights, "class HU", &mixture));
//
// Thread-safe: free functions without state.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "core/hmm/mixture.h"

namespace tactus::internal {

std::vector<double> WeightsOf(const HmmMixture& mixture);

// Sets the weights of `mixture`, which has its components; none means equal
// weights. INVALID_MODEL, with `where` first, if their number is wrong or if
// the mixture is then not valid.
absl::Status SetWeights(const std::vector<double>& weights,
                        absl::string_view where, HmmMixture* mixture);

}  // namespace tactus::internal
