#include "core/questions/question_table.h"

#include <algorithm>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/limits_questions.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/base/text_cells.h"
#include "core/base/text_lines.h"

namespace tactus::internal {
namespace {

constexpr absl::string_view kClass = "class";
constexpr absl::string_view kMobility = "mobility";
constexpr absl::string_view kStateSuffix = ":state";
constexpr absl::string_view kPropertySuffix = ":property";

absl::Status CellError(size_t line, size_t column, absl::string_view got,
                       absl::string_view want) {
  return InvalidConfig(
      absl::StrCat("line ", line, ", column ", column, " of the label table"),
      Quoted(got), want);
}

// The cells of a line with their doubled quotes undone.
absl::StatusOr<std::vector<std::string>> CellsOf(const TextLines& lines) {
  std::vector<absl::string_view> cells;
  if (!IsUtf8(lines.line()) || !SplitCells(lines.line(), ',', &cells)) {
    return InvalidConfig(
        absl::StrCat("line ", lines.number(), " of the label table"),
        Quoted(lines.line()),
        "UTF-8 text whose quotes are closed and end their cell");
  }
  std::vector<std::string> owned;
  for (const absl::string_view cell : cells) {
    owned.push_back(absl::StrReplaceAll(cell, {{"\"\"", "\""}}));
  }
  return owned;
}

absl::StatusOr<Question> ParseHeaderCell(const std::string& cell, size_t line,
                                         size_t column) {
  const size_t colon = cell.find(':');
  Question question;
  question.name = cell.substr(0, colon);
  if (colon == std::string::npos) {
    question.kind =
        question.name == kMobility ? Question::kState : Question::kProperty;
  } else if (cell.substr(colon) == kStateSuffix) {
    question.kind = Question::kState;
  } else if (cell.substr(colon) != kPropertySuffix) {
    return CellError(line, column, cell,
                     "a name, or a name with :state or :property");
  }
  if (question.name.empty() ||
      !TextFault(question.name, limits::kMaxQuestionNameBytes).empty()) {
    return CellError(line, column, cell,
                     absl::StrCat("a name of 1 to ",
                                  limits::kMaxQuestionNameBytes, " bytes"));
  }
  return question;
}

absl::Status ParseHeader(const TextLines& lines, QuestionTable& table) {
  TACTUS_ASSIGN_OR_RETURN(const auto cells, CellsOf(lines));
  const size_t line = lines.number();
  if (cells.front() != kClass) {
    return CellError(line, 1, cells.front(), "class");
  }
  if (cells.size() < 2 || cells.size() - 1 > limits::kMaxQuestions) {
    return InvalidConfig(absl::StrCat("number of questions in line ", line,
                                      " of the label table"),
                         cells.size() - 1,
                         absl::StrCat("1 to ", limits::kMaxQuestions));
  }
  for (size_t c = 1; c < cells.size(); ++c) {
    TACTUS_ASSIGN_OR_RETURN(Question question,
                            ParseHeaderCell(cells[c], line, c + 1));
    if (std::ranges::count(table.questions, question.name, &Question::name) >
        0) {
      return CellError(line, c + 1, cells[c], "a name that is not repeated");
    }
    table.questions.push_back(std::move(question));
  }
  return absl::OkStatus();
}

absl::Status ParseRow(const TextLines& lines, QuestionTable& table) {
  TACTUS_ASSIGN_OR_RETURN(const auto cells, CellsOf(lines));
  const size_t line = lines.number();
  const size_t columns = table.questions.size() + 1;
  if (cells.size() != columns) {
    return InvalidConfig(
        absl::StrCat("number of cells in line ", line, " of the label table"),
        cells.size(), absl::StrCat(columns, ", as the header has"));
  }
  for (size_t c = 0; c < columns; ++c) {
    if (cells[c].empty() ||
        !TextFault(cells[c], limits::kMaxTrialTextBytes).empty()) {
      return CellError(line, c + 1, cells[c],
                       absl::StrCat("1 to ", limits::kMaxTrialTextBytes,
                                    " bytes without control characters"));
    }
  }
  if (std::ranges::count(table.class_names, cells[0]) > 0) {
    return CellError(line, 1, cells[0], "a class that has no row yet");
  }
  if (table.class_names.size() == limits::kMaxClasses) {
    return InvalidConfig("classes of the label table", limits::kMaxClasses + 1,
                         absl::StrCat("at most ", limits::kMaxClasses));
  }
  table.class_names.push_back(cells[0]);
  for (size_t c = 1; c < columns; ++c) {
    Question& question = table.questions[c - 1];
    const auto found = std::ranges::find(question.values, cells[c]);
    question.value_of_class.push_back(
        static_cast<int>(found - question.values.begin()));
    if (found == question.values.end()) question.values.push_back(cells[c]);
  }
  return absl::OkStatus();
}

std::string Cell(absl::string_view text) {
  const bool plain = text.find_first_of(",\"") == absl::string_view::npos;
  if (plain) return std::string(text);
  return absl::StrCat("\"", absl::StrReplaceAll(text, {{"\"", "\"\""}}), "\"");
}

}  // namespace

absl::StatusOr<QuestionTable> ParseQuestionTable(absl::string_view text) {
  if (text.size() > limits::kMaxQuestionTableBytes) {
    return InvalidConfig(
        "bytes of the label table", text.size(),
        absl::StrCat("at most ", limits::kMaxQuestionTableBytes));
  }
  if (const auto fault = TextFileFault(text); !fault.empty()) {
    return InvalidConfig("the label table", fault, "CSV text");
  }
  QuestionTable table;
  TextLines lines(text);
  if (!lines.Next()) {
    return InvalidConfig("the label table", "empty",
                         "a header line and one row per class");
  }
  TACTUS_RETURN_IF_ERROR(ParseHeader(lines, table));
  while (lines.Next()) TACTUS_RETURN_IF_ERROR(ParseRow(lines, table));
  for (size_t q = 0; q < table.questions.size(); ++q) {
    const Question& question = table.questions[q];
    if (question.values.size() > 1) continue;
    return InvalidConfig(
        absl::StrCat("values in column ", q + 2, " of the label table (",
                     question.name, ")"),
        question.values.size(), "at least 2 that differ");
  }
  return table;
}

std::string FormatQuestionTable(const QuestionTable& table) {
  std::vector<std::string> cells = {std::string(kClass)};
  for (const Question& question : table.questions) {
    cells.push_back(Cell(absl::StrCat(
        question.name,
        question.kind == Question::kState ? kStateSuffix : kPropertySuffix)));
  }
  std::string text = absl::StrCat(absl::StrJoin(cells, ","), "\n");
  for (size_t k = 0; k < table.class_names.size(); ++k) {
    cells = {Cell(table.class_names[k])};
    for (const Question& question : table.questions) {
      cells.push_back(Cell(question.values[question.value_of_class[k]]));
    }
    absl::StrAppend(&text, absl::StrJoin(cells, ","), "\n");
  }
  return text;
}

absl::StatusOr<std::vector<Question>> QuestionsFor(
    const QuestionTable& table, const std::vector<std::string>& class_names) {
  std::vector<Question> questions;
  for (const Question& asked : table.questions) {
    Question question = {asked.name, asked.kind, {}, {}};
    // The new index of each value of the table.
    std::vector<int> place(asked.values.size(), -1);
    for (const std::string& name : class_names) {
      const auto row = std::ranges::find(table.class_names, name);
      if (row == table.class_names.end()) {
        return InvalidConfig("label table", absl::StrCat("no row of ", name),
                             "a row for each class of the data");
      }
      place[asked.value_of_class[row - table.class_names.begin()]] = 0;
    }
    // Values keep the order of the table.
    for (size_t v = 0; v < place.size(); ++v) {
      if (place[v] < 0) continue;
      place[v] = static_cast<int>(question.values.size());
      question.values.push_back(asked.values[v]);
    }
    if (question.values.size() < 2) continue;
    for (const std::string& name : class_names) {
      const auto row = std::ranges::find(table.class_names, name);
      question.value_of_class.push_back(
          place[asked.value_of_class[row - table.class_names.begin()]]);
    }
    questions.push_back(std::move(question));
  }
  if (questions.empty()) {
    return InvalidConfig("label table",
                         "no question that the classes of the data answer "
                         "differently",
                         "at least one");
  }
  return questions;
}

}  // namespace tactus::internal
