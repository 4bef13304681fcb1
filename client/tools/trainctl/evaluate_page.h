// File: evaluate_page.h
//
// The result of `trainctl evaluate` as one HTML page that needs no other file:
// accuracy over time, recall and precision per class, the whole confusion
// matrix however wide, and the trials that were most surely wrong.
//
//   const Json worst = WorstTrials(result, loaded.Pointers());
//   WriteFileBytes(path, EvaluationPage("k-fold, hmm", json, worst));
//
// Thread-safe: free functions without state.
#pragma once

#include <string>
#include <vector>

#include "client/tools/json.h"
#include "core/eval/evaluation.h"
#include "core/train/labelled_contact.h"

namespace tactus::client {

// Up to 20 contacts with a wrong answer, the most probable answer first: trial,
// label, answer, probability. `contacts` are those of the evaluation.
Json WorstTrials(const Evaluation& result,
                 const std::vector<const LabelledContact*>& contacts);

// `evaluation` is from EvaluationToJson(). All text is escaped.
std::string EvaluationPage(const std::string& title, const Json& evaluation,
                           const Json& worst);

}  // namespace tactus::client
