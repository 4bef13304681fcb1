// File: contact_trace.h
//
// ContactTrace: everything that happened in one trial, frame by frame, as a
// server would have seen it: features, posteriors, decision.
//
//   TACTUS_ASSIGN_OR_RETURN(const ContactTrace trace,
//                           TraceContact(trial, layout, model));
//   trace.probability[0].back();  // of the first class, after the last frame
//
// The frames run through ContactPipeline, the class that the server runs, with
// the settings of `trainctl classify` and tactus-stream: a trial is one
// contact, from its onset to its end. Plain data, owns its arrays; the function
// has no state and is thread-safe.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/classify/compiled_model.h"
#include "core/data/trial.h"
#include "core/features/feature.h"
#include "core/skin/layout.h"

namespace tactus::internal::client {

struct ContactTrace {
  // Name and label of the trial.
  std::string id;
  std::string label;
  std::string condition;
  // "N" or "counts", of force and taxels.
  std::string unit;

  // Seconds since onset, one per frame: the frame of the onset is at one frame
  // interval, frames before it at 0 and below.
  std::vector<double> time;
  std::vector<FeatureVector> features;
  // Where the skin was touched for the last time, if frames without touch
  // follow.
  std::optional<double> release_s;

  // Without a model, all of these are empty.
  std::vector<std::string> class_names;
  // [class][frame]; before the onset, the prior.
  std::vector<std::vector<double>> probability;
  std::vector<double> unknown;
  struct Decision {
    int class_index = 0;
    double seconds = 0;
  };
  std::optional<Decision> decision;

  // Empty for ideal signals; else rows x columns taxels per frame.
  SkinLayout layout;
  std::vector<std::vector<float>> frames;

  // The most probable class after the last frame. Needs a model.
  int Answer() const;
};

// `model` may be null: then there are features and no posteriors. `given` is
// the layout of skins that are no preset, with an empty name if there is none.
// INVALID_CONFIG if the trial is never felt, or if it holds ideal signals and
// the model sees the load profile of a skin; errors of ContactPipeline::Create.
absl::StatusOr<ContactTrace> TraceContact(
    const Trial& trial, const SkinLayout& given,
    const std::shared_ptr<const CompiledModel>& model);

}  // namespace tactus::internal::client
