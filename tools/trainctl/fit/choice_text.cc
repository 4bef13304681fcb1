#include "tools/trainctl/fit/choice_text.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {

namespace {

// "HMMs", "HMMs + 2 LSTMs".
std::string ModelsText(int networks) {
  if (networks == 0) return "HMMs";
  return absl::StrCat("HMMs + ", networks, networks == 1 ? " LSTM" : " LSTMs");
}

std::string FoldsText(FoldsBy by) {
  if (by == FoldsBy::kGroups) return "groups left out";
  if (by == FoldsBy::kConditions) return "conditions left out";
  return "stratified";
}

}  // namespace

std::string ChoiceText(const std::optional<PresetChoice>& chosen) {
  if (!chosen) return "";
  const PresetChoice& choice = *chosen;
  const int networks = choice.options.lstm.networks;
  std::string text = absl::StrFormat(
      "Preset %s with %s, chosen by %d folds of %d contacts (%s):\n",
      choice.name, ModelsText(networks), choice.folds, choice.contacts,
      FoldsText(choice.by));
  int best = 0;
  for (const ChoiceCandidate& candidate : choice.candidates) {
    absl::StrAppendFormat(
        &text, "  %-10s  %-14s  %s%s\n", candidate.preset,
        ModelsText(candidate.networks),
        candidate.unfit.empty()
            ? PercentOf(candidate.right, choice.contacts)
            : absl::StrCat("not compared: ", candidate.unfit),
        candidate.preset == choice.name && candidate.networks == networks
            ? "  <- chosen"
            : "");
    best = std::max(best, candidate.right);
  }
  absl::StrAppendFormat(&text, "  %-26s  %s, on summaries of the contacts\n",
                        "1-NN",
                        PercentOf(choice.nearest_right, choice.contacts));
  absl::StrAppendFormat(&text, "  %-26s  %s\n", "chance",
                        Percent(choice.chance));
  absl::StrAppendFormat(
      &text,
      "Rows with an LSTM count the answers of the LSTM alone; the model fuses "
      "both where that is better.\nThe LSTMs took %d of at most %d billion "
      "multiplications (--choice-work).\n",
      choice.work, choice.work_limit);
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
  Json hmm_accuracy = Json::object();
  Json unfit = Json::array();
  Json candidates = Json::array();
  for (const ChoiceCandidate& candidate : choice.candidates) {
    const double accuracy =
        static_cast<double>(candidate.right) / choice.contacts;
    Json json = {{"preset", candidate.preset},
                 {"networks", candidate.networks}};
    if (candidate.unfit.empty()) {
      json["right"] = candidate.right;
      json["accuracy"] = accuracy;
      if (candidate.networks == 0) hmm_accuracy[candidate.preset] = accuracy;
    } else {
      json["unfit"] = candidate.unfit;
      if (candidate.networks == 0) {
        unfit.push_back({candidate.preset, candidate.unfit});
      }
    }
    candidates.push_back(std::move(json));
  }
  return {{"preset", choice.name},
          {"networks", choice.options.lstm.networks},
          {"contacts", choice.contacts},
          {"folds", choice.folds},
          {"by_condition", choice.by == FoldsBy::kConditions},
          {"by_group", choice.by == FoldsBy::kGroups},
          {"candidates", candidates},
          {"work", choice.work},
          {"work_limit", choice.work_limit},
          {"hmm_accuracy", hmm_accuracy},
          {"unfit", unfit},
          {"nearest_accuracy",
           static_cast<double>(choice.nearest_right) / choice.contacts},
          {"chance", choice.chance}};
}

}  // namespace tactus::internal::client
