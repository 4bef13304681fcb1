// File: feature_input.h
//
// From cues to the inputs of the models, as the FeatureSpec says. Used on every
// frame and when fitting.
//
// Thread-safe: free functions without state. Nothing allocates.
#pragma once

#include <span>

#include "core/classify/model.h"

namespace tactus {

// A cue before scaling: x or log(max(x, 0) + log_offset).
double TransformCue(double value, double log_offset);

// Writes inputs.size() scaled inputs to `out`.
void MakeInput(std::span<const ModelInput> inputs, CueTracker& cues,
               std::span<double> out);

// The features that the inputs of both models are computed from.
std::vector<Feature> FeaturesUsed(const FeatureSpec& spec);

// True if an input is of the load profile: the model needs a skin.
bool UsesProfile(const FeatureSpec& spec);

// The cues that models look at, besides the raw features.
struct CueNeeds {
  CueGroups groups = kAllCueGroups;
  bool profile = true;
};
CueNeeds CuesNeeded(const FeatureSpec& spec, bool with_lstms);

// How many cues lie outside of them.
int CountUnused(const CueNeeds& needs);

// INVALID_MODEL naming what is wrong.
absl::Status Validate(const FeatureSpec& spec, bool has_lstm);

}  // namespace tactus
