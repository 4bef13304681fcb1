// File: frontier_data.h
//
// Contacts for the frontier, simulated on the spot: the paper's to fit models
// to, and others at robot conditions of the grid
// (core/sim/experiments/grid_set.h) to test them on.
//
//   TACTUS_ASSIGN_OR_RETURN(const FrontierData data, MakeFrontierData(true));
//
// Uses all processors; same bits each time. Thread-safe.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/sim/experiments/paper_set.h"
#include "core/train/labelled_contact.h"

namespace tactus::client {

// Of noise and drawn conditions.
inline constexpr uint64_t kTrainingSeed = 1;
inline constexpr uint64_t kTestSeed = 7;

struct FrontierData {
  std::vector<LabelledContact> training;
  std::vector<LabelledContact> test;
};

std::vector<const LabelledContact*> Pointers(
    const std::vector<LabelledContact>& contacts);

// What the features are noisy with is drawn from `seed`.
absl::StatusOr<LabelledContact> ContactOf(const SimulatedContact& simulated,
                                          uint64_t seed);

// Ideal signals: the paper's 1,835 trials and 400 of the grid; `quick`: about
// 60 of each.
absl::StatusOr<FrontierData> MakeFrontierData(bool quick);

// Specs of the grid, even over its conditions, every other one fixed.
std::vector<TrialSpec> GridSpecs(int count);

}  // namespace tactus::client
