// File: fit_trees.h
//
// Growing Trees from labelled contacts. Each node takes the best of some random
// numbers with a random threshold each, by the Gini impurity, until a leaf has
// one class. Each contact gives the numbers of its first quarter, of its first
// half and of all of it.
//
//   TACTUS_ASSIGN_OR_RETURN(const Trees trees,
//                           FitTrees(samples, {.shape = {4, 6}}));
//
// Deterministic: the same samples and options give the same bits. Thread-safe:
// a free function without state.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/ridge/history_sample.h"
#include "core/trees/trees.h"

namespace tactus::internal {

struct TreesOptions {
  TaxelShape shape;
  int classes = 0;
  int trees = 200;
  uint64_t seed = 1;
  // Called between the parts of the work; an error ends it.
  std::function<absl::Status()> go_on = [] { return absl::OkStatus(); };
};

// INVALID_TRAINING_DATA if the trees would have more than kMostTreeNodes.
absl::StatusOr<Trees> FitTrees(std::span<const HistorySample> samples,
                               const TreesOptions& options);

}  // namespace tactus::internal
