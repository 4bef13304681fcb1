// File: chosen_preset.h
//
// How a fit's options follow from its flags and from the contacts: the preset
// that was named, or with `--preset=auto` the one that an inner
// cross-validation chooses (core/eval/auto_preset.h). Without the flag,
// contacts of a skin without poses get `auto`, and all others `tuned`.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const ChosenOptions chosen,
//       ChooseOptions(flags.fit, loaded, display.progress()));
//   std::cout << ChoiceText(chosen);
//
// Thread-safe: free functions without state.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/tools/trainctl/command.h"
#include "client/tools/trainctl/fit_flags.h"
#include "core/eval/auto_preset.h"

namespace tactus::client {

struct ChosenOptions {
  FitOptions options;
  // The preset that the options are made of.
  std::string preset;
  // How it was chosen; nothing if it was named.
  std::optional<PresetChoice> choice;
  // All contacts. With --skip-unusable, those that models can be fitted to with
  // each preset in question, and the ids of the others.
  std::vector<const LabelledContact*> contacts;
  std::vector<std::string> unusable;
};

// The contacts point into `loaded`.
absl::StatusOr<ChosenOptions> ChooseOptions(const FitFlags& flags,
                                            const LoadedContacts& loaded,
                                            const Progress& progress);

// Several lines; empty if nothing was chosen.
std::string ChoiceText(const ChosenOptions& chosen);
// Null if nothing was chosen.
Json ChoiceToJson(const ChosenOptions& chosen);

}  // namespace tactus::client
