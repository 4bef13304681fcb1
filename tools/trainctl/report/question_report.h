// File: question_report.h
//
// How an evaluation's answers to each question went, as JSON and as text: how
// soon they are right, how often they mislead, and whether decisions hold. The
// text and the page are made from the JSON, so all hold the same numbers.
//
//   const Json questions = QuestionsToJson(result);
//   std::cout << QuestionsText(questions);
//
// The JSON has one object per question, under its name:
//
// | key | meaning |
// |---|---|
// | kind, values | "property" or "state"; the possible answers |
// | contacts, right, accuracy, ece | of the answers after the last frame |
// | accuracy_at, ece_at | the same at each time since onset |
// | delay_ms | until the right value has p > 0.9: median, p90, p99, missed |
// | delay_ms_late | the same for changes later than 1 s after the onset |
// | settled_ms | until the answer stays right to the end |
// | false_alarms | fraction of contacts in which a wrong value had p > 0.9 |
// | false_alarm_counts | contacts, alarms |
// | early | changes whose new value had p > 0.9 before them |
// | decisions | made, right, fraction, interval, changed or revised, constant |
//
// A quantile that falls among contacts that missed is null, and so is what no
// contact can say. Thread-safe: free functions without state.
#pragma once

#include <string>
#include <vector>

#include "core/eval/evaluation.h"
#include "tools/common/json.h"
#include "tools/trainctl/report/html.h"

namespace tactus::internal::client {

// An object with one entry per question; null if nothing was asked.
Json QuestionsToJson(const Evaluation& result);

// Several lines; empty for null.
std::string QuestionsText(const Json& questions);

// A heading and tables; nothing for null.
void AddQuestions(const Json& questions, Html& html);

}  // namespace tactus::internal::client
