#include "client/tools/trainctl/chosen_preset.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/tools/trainctl/text.h"
#include "core/base/run_on_threads.h"
#include "core/base/status_macros.h"

namespace tactus::client {
namespace {

constexpr char kAuto[] = "auto";
constexpr char kDefault[] = "tuned";

}  // namespace

absl::StatusOr<ChosenOptions> ChooseOptions(const FitFlags& flags,
                                            const LoadedContacts& loaded,
                                            const Progress& progress) {
  const bool choose =
      flags.preset == kAuto || (flags.preset.empty() && loaded.without_poses);
  ChosenOptions chosen;
  chosen.contacts = loaded.Pointers();
  const auto skip = [&](const FitOptions& options) {
    const auto skipped = flags.SkipUnusable(options, chosen.contacts);
    chosen.unusable.insert(chosen.unusable.end(), skipped.begin(),
                           skipped.end());
  };
  if (!choose) {
    chosen.preset = flags.preset.empty() ? kDefault : flags.preset;
    TACTUS_ASSIGN_OR_RETURN(chosen.options, flags.Options(chosen.preset));
    skip(chosen.options);
    return chosen;
  }
  std::vector<std::pair<std::string, FitOptions>> candidates;
  for (const char* preset :
       {"profile", "pattern", "whole-skin", "tuned", "paper"}) {
    TACTUS_ASSIGN_OR_RETURN(FitOptions options, flags.Options(preset));
    skip(options);
    candidates.emplace_back(preset, std::move(options));
  }
  TACTUS_ASSIGN_OR_RETURN(
      chosen.choice,
      ChoosePreset(chosen.contacts, candidates, RunOnThreads, progress));
  chosen.preset = chosen.choice->name;
  chosen.options = chosen.choice->options;
  return chosen;
}

std::string ChoiceText(const ChosenOptions& chosen) {
  if (!chosen.choice) return "";
  const PresetChoice& choice = *chosen.choice;
  std::string text = absl::StrFormat(
      "Preset %s, chosen by %d inner folds (%s) of the HMMs alone:\n",
      chosen.preset, choice.folds,
      choice.by_condition ? "one condition left out in each" : "stratified");
  int best = 0;
  for (const auto& [name, right] : choice.right) {
    absl::StrAppendFormat(&text, "  %-10s %s\n", name,
                          PercentOf(right, choice.contacts));
    best = std::max(best, right);
  }
  for (const auto& [name, why] : choice.unfit) {
    absl::StrAppendFormat(&text, "  %-10s not fitted: %s\n", name, why);
  }
  absl::StrAppendFormat(&text, "  %-10s %s, on summaries of the contacts\n",
                        "1-NN",
                        PercentOf(choice.nearest_right, choice.contacts));
  absl::StrAppendFormat(&text, "  %-10s %s\n", "chance",
                        Percent(choice.chance));
  if (WilsonInterval(best, choice.contacts).high <
      WilsonInterval(choice.nearest_right, choice.contacts).low) {
    text +=
        "One nearest neighbour does better than every preset: the presets do "
        "not suit these recordings.\n";
  }
  return text;
}

Json ChoiceToJson(const ChosenOptions& chosen) {
  if (!chosen.choice) return nullptr;
  const PresetChoice& choice = *chosen.choice;
  Json accuracy = Json::object();
  for (const auto& [name, right] : choice.right) {
    accuracy[name] = static_cast<double>(right) / choice.contacts;
  }
  return {{"preset", chosen.preset},
          {"contacts", choice.contacts},
          {"folds", choice.folds},
          {"by_condition", choice.by_condition},
          {"hmm_accuracy", accuracy},
          {"unfit", choice.unfit},
          {"nearest_accuracy",
           static_cast<double>(choice.nearest_right) / choice.contacts},
          {"chance", choice.chance}};
}

}  // namespace tactus::client
