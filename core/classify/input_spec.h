// File: input_spec.h
//
// Makes the inputs of the models from cues, as the InputSpec of a model says.
// Classifying uses it on every frame, and fitting uses it too.
//
//   MakeInput(model.inputs.hmm, cues, input);
//   hmms.Step(input);
//
// Thread-safe: free functions without state. Nothing allocates.
#pragma once

#include <span>

#include "core/classify/model.h"
#include "core/cues/cue_tracker.h"

namespace tactus::internal {

// Returns a cue before scaling: x, or log(max(x, 0) + log_offset).
double TransformCue(double value, double log_offset);

// Returns the scaled input that a cue's value makes.
double ScaleCue(const ModelInput& input, double value);

// Writes inputs.size() scaled inputs to `out`.
void MakeInput(std::span<const ModelInput> inputs, CueTracker& cues,
               std::span<double> out);

// Returns the features that the inputs of HMMs and LSTMs are computed from.
std::vector<Feature> FeaturesUsed(const InputSpec& spec);

// True if an input is made from the load profile.
bool UsesProfile(const InputSpec& spec);

// True if an input is made from the taxels of a skin (ContactSample::loads).
bool UsesTaxels(const InputSpec& spec);

// True if an input is made from the load profile, from taxels or from the
// spread of the load, so that ideal signals cannot be classified.
bool NeedsSkin(const InputSpec& spec);

// The groups of the cues that inputs are made from.
CueGroups CuesNeeded(const InputSpec& spec, bool with_lstms);

// Returns the number of cues outside of `groups` and of the raw features.
int CountUnused(CueGroups groups);

// Returns INVALID_MODEL that names what is wrong.
absl::Status Validate(const InputSpec& spec, bool has_hmms, bool has_lstm);

}  // namespace tactus::internal
