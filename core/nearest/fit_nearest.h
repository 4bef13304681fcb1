// File: fit_nearest.h
//
// Fitting a Nearest to labelled contacts: chooses whether components count
// beside the loads (core/taxels/components.h), the view, and whether its
// numbers are standardised, by how many contacts the nearest contact of
// another group answers rightly.
//
//   TACTUS_ASSIGN_OR_RETURN(const Nearest nearest,
//                           FitNearest(samples, {.shape = {4, 6}}));
//
// Deterministic: the same samples and options give the same bits. Thread-safe:
// a free function without state.
#pragma once

#include <functional>
#include <span>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/nearest/nearest.h"
#include "core/ridge/history_sample.h"

namespace tactus::internal {

struct NearestOptions {
  TaxelShape shape;
  int classes = 0;
  // Called between the parts of the work; an error ends it.
  std::function<absl::Status()> go_on = [] { return absl::OkStatus(); };
};

// INVALID_TRAINING_DATA if a model would keep more than kMostNearestNumbers.
absl::StatusOr<Nearest> FitNearest(std::span<const HistorySample> samples,
                                   const NearestOptions& options);

}  // namespace tactus::internal
