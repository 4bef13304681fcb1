// File: frontier_classifier.h
//
// What each part of a classifier costs on a frame and what it brings: HMMs and
// LSTMs alone, in several numbers and paces, and together as they are served.
//
//   TACTUS_ASSIGN_OR_RETURN(auto ladder, MeasureClassifiers(data, quick));
//
// Every variant runs as the product does, through ContactClassifier; what is
// timed are the frames up to 1.2 s after onset. Thread-safe.
#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "core/classify/compiled_model.h"
#include "tests/bench/frontier_data.h"
#include "tests/bench/frontier_point.h"

namespace tactus::client {

// When accuracies are taken.
inline constexpr double kFrontierSeconds = 1.2;

struct ClassifierLadder {
  std::vector<FrontierPoint> points;
  // The whole model, as it is served.
  std::shared_ptr<const CompiledModel> served;
};

// Of `contacts`, `model` tells so many right kFrontierSeconds after onset.
absl::StatusOr<double> AccuracyOf(
    const std::shared_ptr<const CompiledModel>& model,
    const std::vector<LabelledContact>& contacts);

absl::StatusOr<ClassifierLadder> MeasureClassifiers(const FrontierData& data,
                                                    bool quick);

}  // namespace tactus::client
