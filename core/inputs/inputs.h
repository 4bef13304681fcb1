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
#include "core/base/work.h"
#include "core/classify/input_spec.h"
#include "core/contacts/labelled_contact.h"
#include "core/contacts/varied_contacts.h"
#include "core/inputs/cue_table.h"

namespace tactus::internal {

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
  // Each of these cues also gives inputs that rise from -1 to 1 over one
  // stretch of the cue and are constant elsewhere: `stretches` of them, between
  // its quantiles. A step that is small on the whole range is large on its
  // stretch (piecewise linear encoding, Gorishniy et al., NeurIPS 2022).
  std::vector<Cue> stretched_cues = {};
  int stretches = 0;
  // Scaled inputs are clamped to plus and minus this. Beyond it a cue is
  // outside of the training range, and its distance does not matter.
  double limit = std::numeric_limits<double>::infinity();
  // For cues made from taxels, without which they are 0. Not owned.
  const TaxelEmbedding* embedding = nullptr;
  // The cues are kept if they take at most so many bytes.
  size_t kept_bytes = 0;
};

// Returns the number of frames that WalkCues visits.
size_t CountSteps(const LabelledContact& contact, const StepIntervals& steps);

// Calls `visit` for every touched frame at which `steps` makes a step due, with
// the cues and the index of the frame in the contact. Cues of groups outside of
// `groups` are 0, and so are those made from taxels without an `embedding`.
void WalkCues(const LabelledContact& contact, const StepIntervals& steps,
              CueGroups groups, const TaxelEmbedding* embedding,
              absl::FunctionRef<void(CueTracker& cues, size_t frame)> visit);

// The groups of the cues that `inputs` are made from.
CueGroups GroupsOf(std::span<const ModelInput> inputs);

// Returns one input per cue, scaled over all contacts, and then those of the
// stretched cues. All contacts must have the same rate. Writes the cues that it
// went through to `table`, if that is not null: first `cues`, then the
// stretched ones. The number of threads does not change a bit.
std::vector<ModelInput> FitInputs(const VariedContacts& contacts,
                                  std::span<const Cue> cues,
                                  const InputOptions& options,
                                  const ParallelFor& parallel = RunSerially,
                                  CueTable* table = nullptr);

// Appends the scaled inputs of the frames that WalkCues visits to `rows`,
// frames x inputs, row-major.
void AppendSequence(const LabelledContact& contact,
                    std::span<const ModelInput> inputs,
                    const StepIntervals& steps, const TaxelEmbedding* embedding,
                    std::vector<double>& rows);

// Returns them.
std::vector<double> MakeSequence(const LabelledContact& contact,
                                 std::span<const ModelInput> inputs,
                                 const StepIntervals& steps,
                                 const TaxelEmbedding* embedding = nullptr);
}  // namespace tactus::internal
