// File: frontier_precision.h
//
// Time and error of the HMM scores in the precisions of hmm_scorers.h. The
// observations are the HMM inputs of contacts.
//
//   TACTUS_ASSIGN_OR_RETURN(auto points, MeasurePrecision(model, test, quick));
//
// Thread-safe: a function without state.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/classify/model.h"
#include "core/train/labelled_contact.h"
#include "tests/bench/frontier.h"

namespace tactus::client {

// An error is the largest of a category's log-likelihood, in nats per scored
// frame, against logarithms in long double. Returns NUMERICAL_FAILURE if an
// error exceeds the scorer's stated bound; pruned scorers state none.
absl::StatusOr<std::vector<FrontierPoint>> MeasurePrecision(
    const Model& model, const std::vector<LabelledContact>& contacts,
    bool quick);

}  // namespace tactus::client
