// File: evaluate_report.h
//
// The result of `trainctl evaluate`, as JSON and as text. The text is made from
// the JSON, so both hold the same numbers.
//
//   const Json json = EvaluationToJson(result, loaded.trials);
//   std::cout << EvaluationText(json);
//
// Every accuracy comes with its denominator and its 95 % interval. Thread-safe:
// free functions without state.
#pragma once

#include <string>
#include <vector>

#include "core/contacts/labelled_contact.h"
#include "core/eval/evaluation.h"
#include "core/eval/unknown.h"
#include "tools/trainctl/command.h"

namespace tactus::internal::client {

// `trials` counts the trials of the file; those without an outcome were never
// felt. Absent estimates and decisions are null.
Json EvaluationToJson(const Evaluation& result, int trials);

// The part of it that follows from a confusion matrix: classes, recall and
// precision of each, and the most frequent confusions.
Json ConfusionToJson(const std::vector<std::string>& class_names,
                     const Confusion& confusion);

// A contact that was classified wrongly, by the names of its trial and classes.
struct WrongAnswer {
  std::string name;
  std::string label;
  std::string answer;
};
std::vector<WrongAnswer> WrongAnswers(
    const Evaluation& result,
    const std::vector<const LabelledContact*>& contacts);

// Adds the names of the trials to the confusions of `evaluation`.
void NameConfusions(const std::vector<WrongAnswer>& wrong, Json& evaluation);

// Several lines, from the accuracy over the recall of each class to the
// confusion matrix, if that is not too wide for a terminal. Ends with a
// newline.
std::string EvaluationText(const Json& evaluation);

// The results for contacts of left-out classes.
Json UnknownToJson(const std::vector<UnknownResult>& results);
std::string UnknownText(const std::vector<UnknownResult>& results);

}  // namespace tactus::internal::client
