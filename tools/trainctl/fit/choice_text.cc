#include "tools/trainctl/fit/choice_text.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {

namespace {

// "HMMs", "HMMs + 2 LSTMs", "ridge".
std::string ModelsText(Learner learner, int networks) {
  const std::string alone = LearnerText(learner);
  if (networks == 0) return alone;
  return absl::StrCat(alone, " + ", networks,
                      networks == 1 ? " LSTM" : " LSTMs");
}

double AccuracyOf(const ChoiceCandidate& candidate,
                  const PresetChoice& choice) {
  return static_cast<double>(candidate.right) / choice.contacts;
}

std::string FoldsText(FoldsBy by) {
  if (by == FoldsBy::kGroups) return "groups left out";
  if (by == FoldsBy::kConditions) return "conditions left out";
  return "stratified";
}

}  // namespace

std::string LearnerText(Learner learner) {
  constexpr const char* kNames[] = {"HMMs", "ridge", "trees", "1-NN"};
  return kNames[static_cast<int>(learner)];
}

std::string CandidateLine(const ChoiceCandidate& candidate, int contacts) {
  return absl::StrFormat("  %-10s  %-14s  %s", candidate.preset,
                         ModelsText(candidate.learner, candidate.networks),
                         candidate.unfit.empty()
                             ? PercentOf(candidate.right, contacts)
                             : absl::StrCat("not compared: ", candidate.unfit));
}

std::string ChoiceText(const std::optional<PresetChoice>& chosen) {
  if (!chosen) return "";
  const PresetChoice& choice = *chosen;
  std::string text = absl::StrFormat(
      "Preset %s (%s), chosen by %d folds of %d contacts (%s):\n", choice.name,
      ModelsText(choice.options.learner, choice.options.lstm.networks),
      choice.folds, choice.contacts, FoldsText(choice.by));
  int best = 0;
  for (const ChoiceCandidate& candidate : choice.candidates) {
    absl::StrAppend(&text, CandidateLine(candidate, choice.contacts),
                    IsChosen(candidate, choice) ? "  <- chosen" : "", "\n");
    best = std::max(best, candidate.right);
  }
  absl::StrAppendFormat(&text, "  %-26s  %s\n", "1-NN of summaries",
                        PercentOf(choice.nearest_right, choice.contacts));
  absl::StrAppendFormat(&text, "  %-26s  %s\n", "chance",
                        Percent(choice.chance));
  text +=
      "Chosen is the cheapest that is not clearly worse than the best: HMMs "
      "cost least, then a ridge, trees, 1-NN, and LSTMs.\n";
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
    const double accuracy = AccuracyOf(candidate, choice);
    Json json = {{"preset", candidate.preset},
                 {"networks", candidate.networks}};
    if (candidate.unfit.empty()) {
      json["right"] = candidate.right;
      json["accuracy"] = accuracy;
      if (candidate.networks == 0 && candidate.learner == Learner::kHmms)
        hmm_accuracy[candidate.preset] = accuracy;
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

Json CandidatesToJson(const std::optional<PresetChoice>& chosen) {
  Json list = Json::array();
  if (!chosen) return list;
  for (const ChoiceCandidate& candidate : chosen->candidates) {
    if (!candidate.unfit.empty()) continue;
    const double accuracy = AccuracyOf(candidate, *chosen);
    list.push_back(
        {{"name",
          absl::StrCat(candidate.preset, " (",
                       ModelsText(candidate.learner, candidate.networks), ")")},
         {"accuracy", accuracy},
         {"standard_error",
          std::sqrt(accuracy * (1 - accuracy) / chosen->contacts)},
         {"chosen", IsChosen(candidate, *chosen)}});
  }
  return list;
}

}  // namespace tactus::internal::client
