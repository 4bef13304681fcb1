#include "core/eval/chosen_options.h"

#include <algorithm>
#include <utility>

#include "core/base/status_macros.h"
#include "core/contacts/class_counts.h"
#include "core/train/usable.h"

namespace tactus::internal {
namespace {

// True if the preset follows from the contacts.
bool Chooses(const OptionsRequest& request) {
  return request.preset == kAutoPreset ||
         (request.preset.empty() && request.without_poses);
}

// The preset of a request that does not choose.
std::string NamedPreset(const OptionsRequest& request) {
  return request.preset.empty() ? "tuned" : request.preset;
}

// Removes the contacts of classes without a label, and of those with too few
// contacts for a fit, for the choice of a preset if there is one, or for the
// folds of an evaluation. Fewer contacts make other folds, so it repeats.
void SkipSmallClasses(const OptionsRequest& request, ChosenOptions& chosen) {
  std::vector<std::string> small;
  do {
    small = SmallClasses(CountClasses(chosen.contacts));
    if (small.empty() && request.protocol) {
      const auto folds = MakeFolds(chosen.contacts, *request.protocol);
      if (folds.ok()) small = SmallClasses(chosen.contacts, *folds);
    }
    if (small.empty() && Chooses(request)) {
      small =
          SmallClasses(chosen.contacts, FoldsForChoice(chosen.contacts).folds);
    }
    std::erase_if(chosen.contacts, [&](const LabelledContact* contact) {
      if (std::ranges::count(small, contact->label) == 0) return false;
      chosen.unusable.push_back(contact->id);
      return true;
    });
  } while (!small.empty());
}

// Removes the contacts that models of these options cannot be fitted to.
void SkipUnusable(const FitOptions& options, ChosenOptions& chosen) {
  std::erase_if(chosen.contacts, [&](const LabelledContact* contact) {
    if (IsUsable(*contact, options)) return false;
    chosen.unusable.push_back(ContactName(*contact));
    return true;
  });
}

}  // namespace

absl::StatusOr<bool> NeedsWholeSkin(const OptionsRequest& request) {
  if (Chooses(request)) return true;
  TACTUS_ASSIGN_OR_RETURN(const FitOptions options,
                          request.options_of(NamedPreset(request)));
  return UsesWholeSkin(options);
}

absl::StatusOr<ChosenOptions> ChooseOptions(
    const std::vector<const LabelledContact*>& contacts,
    const OptionsRequest& request, const ParallelFor& parallel,
    const Progress& progress, Ranks* ranks) {
  ChosenOptions chosen;
  chosen.contacts = contacts;
  if (!Chooses(request)) {
    chosen.preset = NamedPreset(request);
    TACTUS_ASSIGN_OR_RETURN(chosen.options, request.options_of(chosen.preset));
    if (request.skip_unusable) {
      SkipUnusable(chosen.options, chosen);
      SkipSmallClasses(request, chosen);
    }
    return chosen;
  }
  ChoiceRequest choice = {.networks_given = request.networks_given,
                          .work_limit = request.choice_work,
                          .considered = request.considered,
                          .cancelled = request.cancelled};
  for (const char* preset : {"profile", "pattern", "whole-skin", "tuned",
                             "paper", "ridge", "trees", "nearest"}) {
    TACTUS_ASSIGN_OR_RETURN(FitOptions options, request.options_of(preset));
    options.inner_folds = InnerFolds::kChoice;
    if (request.skip_unusable) SkipUnusable(options, chosen);
    choice.presets.emplace_back(preset, std::move(options));
  }
  if (request.skip_unusable) SkipSmallClasses(request, chosen);
  TACTUS_ASSIGN_OR_RETURN(
      chosen.choice,
      ChoosePreset(chosen.contacts, choice, parallel, progress, ranks));
  chosen.preset = chosen.choice->name;
  chosen.options = chosen.choice->options;
  return chosen;
}

}  // namespace tactus::internal
