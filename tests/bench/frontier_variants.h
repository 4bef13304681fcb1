// File: frontier_variants.h
//
// Classifiers of one kind in several sizes: parts of a fitted model, and models
// fitted with other numbers and paces.
//
//   TACTUS_ASSIGN_OR_RETURN(auto variants, FitVariants(contacts, quick));
//
// Uses all processors; the same contacts give the same models. Thread-safe.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/classify/compiled_model.h"
#include "core/classify/skip_rules.h"
#include "core/train/labelled_contact.h"

namespace tactus::client {

struct ClassifierVariant {
  std::string family;
  std::string name;
  std::shared_ptr<const CompiledModel> model;
  SkipRules skip = {};
};

// Places of the preset `tuned` as it is served, of the same with all skip rules
// off, and of its HMMs and its LSTMs alone.
inline constexpr int kServedVariant = 0;
inline constexpr int kUnskippedVariant = 1;
inline constexpr int kHmmVariant = 2;
inline constexpr int kLstmVariant = 3;

// These, less of them, and others, which are not calibrated where that leaves
// the answers as they are. `quick`: tiny ones.
absl::StatusOr<std::vector<ClassifierVariant>> FitVariants(
    const std::vector<LabelledContact>& contacts, bool quick);

}  // namespace tactus::client
