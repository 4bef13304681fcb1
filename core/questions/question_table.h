// File: question_table.h
//
// The label table: a small CSV file in which a person writes what each class
// answers to each question.
//
//   class,hardness,mobility:state
//   HU,hard,unmoved
//   HM,hard,moved
//
// The header is "class" and the names of the questions. A name may be followed
// by ":property" or ":state"; without it, "mobility" is a state and every other
// question a property. One row per class; values have the order in which they
// first appear. Cells are read as those of any table (core/base/text_cells.h).
//
//   TACTUS_ASSIGN_OR_RETURN(const QuestionTable table,
//                           ParseQuestionTable(text));
//   TACTUS_ASSIGN_OR_RETURN(model.questions,
//                           QuestionsFor(table, model.class_names));
//
// Plain data and free functions without state; thread-safe.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/questions/question.h"

namespace tactus::internal {

struct QuestionTable {
  std::vector<std::string> class_names;
  // Over `class_names`.
  std::vector<Question> questions;
};

// INVALID_CONFIG that names the line and the column (of cells, from 1).
absl::StatusOr<QuestionTable> ParseQuestionTable(absl::string_view text);

// The inverse; it always writes the kinds.
std::string FormatQuestionTable(const QuestionTable& table);

// The questions over the classes of a model, in the model's order. Classes that
// the model does not have are ignored, with the values that only they answer.
// A question that is left with one value is left out. INVALID_CONFIG for a
// class that the table does not have, or if no question is left.
absl::StatusOr<std::vector<Question>> QuestionsFor(
    const QuestionTable& table, const std::vector<std::string>& class_names);

}  // namespace tactus::internal
