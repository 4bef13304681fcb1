#include "client/tools/trainctl/choice_text.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/tools/trainctl/text.h"

namespace tactus::client {

std::string ChoiceText(const std::optional<PresetChoice>& chosen) {
  if (!chosen) return "";
  const PresetChoice& choice = *chosen;
  std::string text = absl::StrFormat(
      "Preset %s, chosen by %d inner folds (%s) of the HMMs alone:\n",
      choice.name, choice.folds,
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

Json ChoiceToJson(const std::optional<PresetChoice>& chosen) {
  if (!chosen) return nullptr;
  const PresetChoice& choice = *chosen;
  Json accuracy = Json::object();
  for (const auto& [name, right] : choice.right) {
    accuracy[name] = static_cast<double>(right) / choice.contacts;
  }
  return {{"preset", choice.name},
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
