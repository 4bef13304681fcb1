// File: frontier_classifier.h
//
// Time per frame and accuracy of the classifiers of frontier_models.h: HMMs and
// LSTMs alone, in several sizes and with several step intervals, and together
// as served.
//
//   TACTUS_ASSIGN_OR_RETURN(auto measured, MeasureClassifiers(contacts,
//   quick));
//
// Every variant runs through ContactClassifier, as in the server. The time is
// that of the frames up to 1.2 s after onset. Thread-safe: functions without
// state.
#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "core/classify/compiled_model.h"
#include "tests/bench/frontier.h"
#include "tests/bench/frontier_models.h"

namespace tactus::client {

// Accuracies are measured at this time after onset.
inline constexpr double kFrontierSeconds = 1.2;

struct MeasuredClassifiers {
  std::vector<FrontierPoint> points;
  // The whole model, as served.
  std::shared_ptr<const CompiledModel> served;
};

// The fraction of `contacts` that `model` classifies correctly kFrontierSeconds
// after onset.
absl::StatusOr<double> AccuracyOf(
    const std::shared_ptr<const CompiledModel>& model,
    const std::vector<LabelledContact>& contacts);

absl::StatusOr<MeasuredClassifiers> MeasureClassifiers(
    const FrontierContacts& contacts, bool quick);

}  // namespace tactus::client
