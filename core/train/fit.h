// File: fit.h
//
// Fitting a Model to labelled contacts: feature scaling, one mixture of HMMs
// per class, calibration on inner folds.
//
//   TACTUS_ASSIGN_OR_RETURN(FitOptions options, FitPreset("tuned"));
//   TACTUS_ASSIGN_OR_RETURN(Model model,
//                           FitModel(contacts, options, RunSerially));
//
// Deterministic: the same contacts, options and seed give the same model,
// however `parallel` and the ranks share out the work and wherever a journal
// interrupted it.
// Thread-safe.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/ranks.h"
#include "core/base/work.h"
#include "core/classify/model.h"
#include "core/contacts/labelled_contact.h"
#include "core/train/fit_journal.h"
#include "core/train/fit_options.h"

namespace tactus::internal {

// The times at which the answers of models of these inputs are calibrated
// (CalibrationFrames).
std::vector<double> FramesToCalibrate(
    const std::vector<const LabelledContact*>& contacts,
    const FitOptions& options, const InputSpec& inputs);

// Returns the labels of `contacts`: HU, HM, SU, SM first if present, then the
// others in alphabetical order.
std::vector<std::string> ClassNames(
    const std::vector<const LabelledContact*>& contacts);

// Fits a model. INVALID_TRAINING_DATA if there are fewer than two classes or
// fewer than two contacts of some class, if skins or sampling rates are mixed,
// if cues of the load profile are asked of ideal signals, or if a contact is
// not usable (usable.h). INVALID_CONFIG if
// the features allow no cue, or if the label table has no row of some class.
// CANCELLED or CHECKPOINT_INVALID as fit_journal.h
// describes. Of the provenance, the caller fills in everything but trials,
// their fingerprints and seed. `journal` may be null and must outlive the call.
// `start`, if there is one, lends its threads instead of those of `parallel`
// until the first iteration. All `ranks`, if there are some, must call it with
// the same contacts and options; each gets the model.
absl::StatusOr<Model> FitModel(
    const std::vector<const LabelledContact*>& contacts,
    const FitOptions& options, const ParallelFor& parallel,
    const Progress& progress = {}, FitJournal* journal = nullptr,
    const ParallelFor& start = {}, Ranks* ranks = nullptr);

}  // namespace tactus::internal
