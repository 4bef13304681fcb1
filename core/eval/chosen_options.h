// File: chosen_options.h
//
// How a fit's options follow from what was asked for and from the contacts: the
// preset that was named, or with "auto" the one that an inner cross-validation
// chooses, and whether it gets LSTMs (auto_preset.h). Without a name, contacts
// of a skin without poses get "auto", and all others "tuned".
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const ChosenOptions chosen,
//       ChooseOptions(contacts, {.preset = "auto", .options_of = FitPreset},
//                     RunSerially));
//   FitModel(chosen.contacts, chosen.options, RunSerially);
//
// Deterministic. Thread-safe: free functions without state.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/base/ranks.h"
#include "core/base/status_macros.h"
#include "core/base/work.h"
#include "core/contacts/folds.h"
#include "core/contacts/labelled_contact.h"
#include "core/eval/auto_preset.h"
#include "core/train/fit_options.h"

namespace tactus::internal {

struct OptionsRequest {
  // A name that `options_of` knows, kAutoPreset, or empty.
  std::string preset = {};
  // Some contact comes from taxels without poses.
  bool without_poses = false;
  // Leaves out the contacts that models cannot be fitted to (usable.h), and
  // those of classes that have too few (class_counts.h).
  bool skip_unusable = false;
  // How the options will be evaluated: the classes must suffice for its folds.
  std::optional<Protocol> protocol = {};
  // See ChoiceRequest.
  bool networks_given = false;
  int choice_work = kDefaultChoiceWork;
  std::function<void(const ChoiceCandidate&, int contacts)> considered = {};
  std::function<bool()> cancelled = {};
  // The options of a preset, with what else was asked for.
  std::function<absl::StatusOr<FitOptions>(absl::string_view preset)>
      options_of;
};

struct ChosenOptions {
  FitOptions options;
  // The preset that the options are made of.
  std::string preset;
  // How it was chosen; nothing if it was named.
  std::optional<PresetChoice> choice;
  // All contacts; if unusable ones are skipped, those that models can be fitted
  // to with each preset in question, and the ids of the others.
  std::vector<const LabelledContact*> contacts;
  std::vector<std::string> unusable;
};

// True if models of the request may look at more of the skin than the features
// (ExtractOptions::whole_skin).
absl::StatusOr<bool> NeedsWholeSkin(const OptionsRequest& request);

// Reads contacts with as much of the skin as models of the request look at.
// `read(whole_skin)` returns a StatusOr of a type with a member without_poses.
// Only the contacts show that there are no poses, and that may choose other
// models; then they are read again. The errors of `options_of` and of `read`.
template <typename Read>
auto ReadForFit(OptionsRequest request, const Read& read)
    -> decltype(read(true)) {
  request.without_poses = false;
  TACTUS_ASSIGN_OR_RETURN(const bool at_first, NeedsWholeSkin(request));
  auto contacts = read(at_first);
  if (!contacts.ok()) return contacts;
  request.without_poses = contacts->without_poses;
  TACTUS_ASSIGN_OR_RETURN(const bool whole_skin, NeedsWholeSkin(request));
  return whole_skin == at_first ? std::move(contacts) : read(whole_skin);
}

// The errors of `options_of` and of ChoosePreset.
absl::StatusOr<ChosenOptions> ChooseOptions(
    const std::vector<const LabelledContact*>& contacts,
    const OptionsRequest& request, const ParallelFor& parallel,
    const Progress& progress = {}, Ranks* ranks = nullptr);

}  // namespace tactus::internal
