// File: frontier_precision.h
//
// What digits of HMM scores cost: the forward algorithm of all categories'
// HMMs scaled in float, as it is served, scaled in double, with logarithms in
// double, and without states of little weight, on what the HMMs see of
// contacts.
//
//   TACTUS_ASSIGN_OR_RETURN(auto points, MeasurePrecision(model, test, quick));
//
// Thread-safe.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/classify/model.h"
#include "core/train/labelled_contact.h"
#include "tests/bench/frontier_point.h"

namespace tactus::client {

// Errors are of a category's log-likelihood, nats per scored frame, against
// logarithms in long double. NUMERICAL_FAILURE if a precision is off by more
// than it states; leaving out states states nothing.
absl::StatusOr<std::vector<FrontierPoint>> MeasurePrecision(
    const Model& model, const std::vector<LabelledContact>& contacts,
    bool quick);

}  // namespace tactus::client
