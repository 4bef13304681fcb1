// File: auto_preset.h
//
// Chooses how to fit models to contacts of an unknown skin, by an inner
// cross-validation over candidates, with two baselines beside them: one nearest
// neighbour on summaries of the contacts, and chance.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const PresetChoice choice,
//       ChoosePreset(contacts, {{"tuned", tuned}, {"profile", profile}},
//                    RunSerially));
//   FitModel(contacts, choice.options, RunSerially);
//
// The candidates' HMMs are compared, without LSTMs and without calibration:
// this takes a tenth of the time, and the best class of the HMMs does not
// depend on a calibration. Deterministic. Thread-safe: a free function without
// state.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/work.h"
#include "core/contacts/folds.h"
#include "core/contacts/labelled_contact.h"
#include "core/train/fit_options.h"

namespace tactus {

// The folds where the contacts ask for no others.
inline const Protocol kChoiceProtocol(Protocol::kKFold, 3);

struct PresetChoice {
  // Of the first candidate with most right answers.
  std::string name;
  FitOptions options;
  // The candidates that could be fitted, in the order given, and how many
  // contacts their HMMs answered rightly.
  std::vector<std::pair<std::string, int>> right;
  // The candidates that could not be fitted, and why.
  std::vector<std::pair<std::string, std::string>> unfit;
  int nearest_right = 0;
  int contacts = 0;
  int folds = 0;
  // True if each fold left a robot condition out.
  bool by_condition = false;
  // Fraction that the most frequent class would get.
  double chance = 0;
};

// The folds leave one robot condition out where there are 2 to 8 and each class
// is in all of the rest; else there are three stratified ones. A candidate that
// does not suit the contacts (the load profile of ideal signals) is left out.
// INVALID_TRAINING_DATA if none suits them, or if a class has fewer than three
// contacts.
absl::StatusOr<PresetChoice> ChoosePreset(
    const std::vector<const LabelledContact*>& contacts,
    const std::vector<std::pair<std::string, FitOptions>>& candidates,
    const ParallelFor& parallel, const Progress& progress = {});

}  // namespace tactus
