// File: auto_preset.h
//
// Chooses how to fit models to contacts of an unknown skin: compares presets,
// without and with LSTMs, by a cross-validation that leaves out what the
// contacts ask for (choice_folds.h), with two baselines beside them: one
// nearest neighbour on summaries of the contacts, and chance.
//
// The chosen candidate is the cheapest of those that are not clearly worse than
// the best: not by more than one standard error of the difference, over the
// same contacts. HMMs cost least, then a ridge, trees, nearest neighbours, and
// LSTMs; of candidates that cost the same, the one with more right answers is
// taken.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const PresetChoice choice,
//       ChoosePreset(contacts,
//                    {.presets = {{"tuned", tuned}, {"profile", profile}}},
//                    RunSerially));
//   FitModel(contacts, choice.options, RunSerially);
//
// First the presets are compared without LSTMs, then those of HMMs with LSTMs,
// the best first, as far as the limit on their work goes. The limit counts
// multiplications and not time (lstm_work.h), so the same contacts give the
// same choice. Deterministic. Thread-safe: a free function without state.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/ranks.h"
#include "core/base/work.h"
#include "core/contacts/choice_folds.h"
#include "core/contacts/labelled_contact.h"
#include "core/train/fit_options.h"

namespace tactus::internal {

// Billions of multiplications: some 15 s of one processor core.
inline constexpr int kDefaultChoiceWork = 150;

// One way to fit models that was considered.
struct ChoiceCandidate {
  std::string preset;
  int networks = 0;
  Learner learner = Learner::kHmms;
  // Contacts that were answered rightly, by the LSTMs if there are some, if
  // `unfit` is empty.
  int right = 0;
  // Why it was not compared.
  std::string unfit = {};
};

struct ChoiceRequest {
  // Names and options. LstmFit::networks is what a model with LSTMs has; 0
  // means 1.
  std::vector<std::pair<std::string, FitOptions>> presets = {};
  // Compares the presets with the numbers of networks that they have, instead
  // of with and without LSTMs.
  bool networks_given = false;
  // Work that LSTMs may cost, in billions of multiplications.
  int work_limit = kDefaultChoiceWork;
  // Called with each candidate when its answers to the contacts are counted, on
  // the calling thread.
  std::function<void(const ChoiceCandidate&, int contacts)> considered = {};
  // As for RightOutOfFold; may be empty.
  std::function<bool()> cancelled = {};
};

struct PresetChoice {
  // The chosen one.
  std::string name;
  FitOptions options;
  // In the order in which they were considered.
  std::vector<ChoiceCandidate> candidates;
  int nearest_right = 0;
  int contacts = 0;
  int folds = 0;
  FoldsBy by = FoldsBy::kClasses;
  // Fraction that the most frequent class would get.
  double chance = 0;
  // What the LSTMs cost, and what they may cost; billions of multiplications.
  int work = 0;
  int work_limit = 0;
};

bool IsChosen(const ChoiceCandidate& candidate, const PresetChoice& choice);

// A candidate that does not suit the contacts (the load profile of ideal
// signals), or whose LSTMs would exceed the limit, is not compared.
// INVALID_TRAINING_DATA if none suits them, or if a class has too few contacts
// for the folds. CANCELLED if the request's function says so.
absl::StatusOr<PresetChoice> ChoosePreset(
    const std::vector<const LabelledContact*>& contacts,
    const ChoiceRequest& request, const ParallelFor& parallel,
    const Progress& progress = {}, Ranks* ranks = nullptr);

}  // namespace tactus::internal
