// File: frontier_models.h
//
// Contacts and classifiers of the frontier. The contacts are simulated in the
// run: the paper's to fit models to, and others at robot conditions of the grid
// (core/sim/experiments/grid_set.h) to test them on. The classifiers are parts
// of one fitted model, and models fitted with other sizes and step intervals.
//
//   TACTUS_ASSIGN_OR_RETURN(const auto contacts, SimulateContacts(true));
//   TACTUS_ASSIGN_OR_RETURN(auto variants, FitVariants(contacts.training,
//   true));
//
// Uses all processors. The same arguments give the same bits. Thread-safe:
// functions without state.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/classify/compiled_model.h"
#include "core/classify/skip_rules.h"
#include "core/contacts/labelled_contact.h"
#include "core/sim/model/trial_spec.h"
#include "core/sim/skin/simulated_contact.h"

namespace tactus::internal::client {

// Seeds of the noise and of the drawn conditions.
inline constexpr uint64_t kTrainingSeed = 1;
inline constexpr uint64_t kTestSeed = 7;

struct FrontierContacts {
  std::vector<LabelledContact> training;
  std::vector<LabelledContact> test;
};

std::vector<const LabelledContact*> Pointers(
    const std::vector<LabelledContact>& contacts);

// The contact of a simulation; the noise of its features is drawn from `seed`.
absl::StatusOr<LabelledContact> ContactOf(const SimulatedContact& simulated,
                                          uint64_t seed);

// Ideal signals: the paper's 1,835 trials and 6,000 contacts of the grid;
// `quick`: about 60 of each.
absl::StatusOr<FrontierContacts> SimulateContacts(bool quick);

// Specs of the grid, spread evenly over its conditions. Every second object is
// fixed.
std::vector<TrialSpec> GridSpecs(int count);

struct ClassifierVariant {
  std::string family;
  std::string name;
  std::shared_ptr<const CompiledModel> model;
  SkipRules skip = {};
};

// Indices of the first variants: the preset `tuned`, the same with all skip
// rules off, its HMMs alone, its LSTM alone.
inline constexpr int kTunedVariant = 0;
inline constexpr int kUnskippedVariant = 1;
inline constexpr int kHmmVariant = 2;
inline constexpr int kLstmVariant = 3;

// The four above, smaller ones, and models with other step intervals. Models
// whose answers do not depend on calibration are not calibrated. `quick`: tiny
// models.
absl::StatusOr<std::vector<ClassifierVariant>> FitVariants(
    const std::vector<LabelledContact>& contacts, bool quick);

}  // namespace tactus::internal::client
