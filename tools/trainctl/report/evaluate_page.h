// File: evaluate_page.h
//
// The result of `trainctl evaluate` as one HTML page that needs no other file
// and no network: accuracy beside its baselines, the confusion matrix however
// wide, recall and precision per class, accuracy over time, whether
// probabilities are right, time to decision, and the worst trials with their
// skin's pictures.
//
//   EvaluationPageParts parts;
//   parts.title = "Evaluation of arm.h5";
//   parts.evaluation = EvaluationToJson(result, loaded.trials);
//   parts.worst = WorstTrials(result, contacts);
//   WriteFileBytes(path, EvaluationPage(parts));
//
// Thread-safe: free functions without state.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/contacts/labelled_contact.h"
#include "core/eval/baselines.h"
#include "core/eval/evaluation.h"
#include "tools/common/json.h"

namespace tactus::internal::client {

// The contacts whose true class got the lowest probability, the lowest first,
// at most 12: trial, label, answer, probability of the answer and of the label.
// `contacts` are those of the evaluation.
Json WorstTrials(const Evaluation& result,
                 const std::vector<const LabelledContact*>& contacts);

// Right answers of each baseline, and in `tested` how they were counted.
Json BaselinesToJson(const Baselines& baselines, const std::string& tested);

// PNG files; empty where there is nothing to draw.
struct EvaluationPictures {
  std::string anytime = {};
  std::string reliability = {};
  std::string decisions = {};
  // One for each of the worst trials, or none.
  std::vector<std::string> worst = {};
};

struct EvaluationPageParts {
  std::string title = {};
  // What was evaluated and how: "data", "arm.h5"; "seed", "1".
  std::vector<std::pair<std::string, std::string>> facts = {};
  // What makes the figures say less than they seem to; may be empty.
  std::string warning = {};
  // Made by EvaluationToJson().
  Json evaluation = {};
  // Made by BaselinesToJson(); null if they were not counted.
  Json baselines = nullptr;
  // Made by WorstTrials().
  Json worst = Json::array();
  EvaluationPictures pictures = {};
};

// All text is escaped. Parts that the evaluation does not have are left out.
std::string EvaluationPage(const EvaluationPageParts& parts);

}  // namespace tactus::internal::client
