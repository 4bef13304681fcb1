// File: fit_ridge.h
//
// Fitting a Ridge to labelled contacts: ridge regression of class indicators,
// solved in the dual because there are more numbers than contacts.
//
//   TACTUS_ASSIGN_OR_RETURN(const Ridge ridge,
//                           FitRidge(samples, {.shape = {4, 6}}));
//
// Each contact gives the numbers of its first quarter, of its first half and of
// all of it, so that the ridge answers at any time. Several strengths of the
// penalty are tried on left-out contacts, and the one with the least log loss
// is taken. If there are components (core/taxels/components.h), a fit to them
// and the loads is compared with one to the loads alone in the same way: on
// another day they can mislead. Answers to left-out contacts have a closed
// form. Source: S. An et al., "Fast Cross-Validation Algorithms for Least
// Squares Support Vector Machine and Kernel Ridge Regression" (Pattern
// Recognition 40, 2007).
//
// Deterministic: the same samples and options give the same bits. Thread-safe:
// free functions without state.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/ridge/history_sample.h"
#include "core/ridge/ridge.h"

namespace tactus::internal {

struct RidgeOptions {
  TaxelShape shape;
  int classes = 0;
  uint64_t seed = 1;
  // Called between the parts of the work; an error ends it.
  std::function<absl::Status()> go_on = [] { return absl::OkStatus(); };
};

absl::StatusOr<Ridge> FitRidge(std::span<const HistorySample> samples,
                               const RidgeOptions& options);

}  // namespace tactus::internal
