// File: inputs.h
//
// Model inputs of whole contacts, for fitting: cues as ContactClassifier
// computes them frame by frame, their scaling, and the sequences they make.
//
//   auto inputs = FitInputs(contacts, cues, {});
//   std::vector<double> rows = MakeSequence(contact, inputs);
//
// Thread-safe: free functions without state.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "absl/functional/function_ref.h"
#include "core/classify/feature_input.h"
#include "core/train/labelled_contact.h"

namespace tactus {

enum class Scaling {
  kStandard,  // zero mean, unit deviation (paper, eq. for S_f)
  kMinMax,    // 0 to 1
};

struct InputOptions {
  Scaling scaling = Scaling::kStandard;
  // Logarithms of the raw features: of x and 2 % of its typical value, so that
  // sensor noise around zero stays small.
  bool log_features = false;
  // Frames that count.
  StepIntervals steps = {};
  // Scaled inputs are held within this: beyond, a cue is out of what was
  // trained on, and how far does not matter.
  double limit = std::numeric_limits<double>::infinity();
};

// Inputs that each rise from -1 to 1 over one stretch of a cue and rest
// elsewhere, `stretches` of them between its quantiles: what is a small step on
// the whole range is a large one on its stretch (piecewise linear encoding,
// Gorishniy et al., NeurIPS 2022).
std::vector<ModelInput> FitStretches(
    const std::vector<const LabelledContact*>& contacts,
    std::span<const Cue> cues, int stretches, const StepIntervals& steps);

// Calls `visit` with the cues at every touched frame that is due by `steps`,
// and the frames since onset.
void WalkCues(const LabelledContact& contact, const StepIntervals& steps,
              absl::FunctionRef<void(CueTracker& cues, size_t frame)> visit);

// One input a cue, scaled over all contacts, each of the same rate.
std::vector<ModelInput> FitInputs(
    const std::vector<const LabelledContact*>& contacts,
    std::span<const Cue> cues, const InputOptions& options);

// Scaled inputs of the touched frames due by `steps`, frames x inputs,
// row-major.
std::vector<double> MakeSequence(const LabelledContact& contact,
                                 std::span<const ModelInput> inputs,
                                 const StepIntervals& steps);
// The same as LSTMs are trained on them.
std::vector<float> MakeLstmSequence(const LabelledContact& contact,
                                    std::span<const ModelInput> inputs,
                                    const StepIntervals& steps);

}  // namespace tactus
