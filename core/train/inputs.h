// File: inputs.h
//
// Model inputs of whole contacts, for fitting: the cues that ContactClassifier
// computes frame by frame, their scaling, and the resulting sequences.
//
//   auto inputs = FitInputs(VariedContacts(contacts), cues, {});
//   std::vector<double> rows = MakeSequence(contact, inputs, steps);
//
// Thread-safe: free functions without state.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "absl/functional/function_ref.h"
#include "core/classify/input_spec.h"
#include "core/train/labelled_contact.h"
#include "core/train/varied_contacts.h"

namespace tactus {

enum class Scaling {
  kStandard,  // zero mean, unit deviation (paper, eq. for S_f)
  kMinMax,    // 0 to 1
};

struct InputOptions {
  Scaling scaling = Scaling::kStandard;
  // Takes the logarithm of raw features. Before that it adds 2 % of the
  // feature's typical value, so that sensor noise around zero stays small.
  bool log_features = false;
  // The frames that are used.
  StepIntervals steps = {};
  // Scaled inputs are clamped to plus and minus this. Beyond it a cue is
  // outside of the training range, and its distance does not matter.
  double limit = std::numeric_limits<double>::infinity();
};

// Returns inputs that each rise from -1 to 1 over one stretch of a cue and are
// constant elsewhere. Each cue has `stretches` of them, between its quantiles.
// A step that is small on the whole range is large on its stretch (piecewise
// linear encoding, Gorishniy et al., NeurIPS 2022).
std::vector<ModelInput> FitStretches(const VariedContacts& contacts,
                                     std::span<const Cue> cues, int stretches,
                                     const StepIntervals& steps);

// Calls `visit` for every touched frame at which `steps` makes a step due, with
// the cues and the index of the frame in the contact.
void WalkCues(const LabelledContact& contact, const StepIntervals& steps,
              absl::FunctionRef<void(CueTracker& cues, size_t frame)> visit);

// Returns one input per cue, scaled over all contacts. All contacts must have
// the same rate.
std::vector<ModelInput> FitInputs(const VariedContacts& contacts,
                                  std::span<const Cue> cues,
                                  const InputOptions& options);

// Returns the scaled inputs of the frames that WalkCues visits, frames x
// inputs, row-major.
std::vector<double> MakeSequence(const LabelledContact& contact,
                                 std::span<const ModelInput> inputs,
                                 const StepIntervals& steps);
// The same in the number format of LSTM training.
std::vector<float> MakeLstmSequence(const LabelledContact& contact,
                                    std::span<const ModelInput> inputs,
                                    const StepIntervals& steps);

}  // namespace tactus
