#include "core/questions/question.h"

#include <algorithm>
#include <optional>
#include <set>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/limits_questions.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"

namespace tactus::internal {
namespace {

absl::Status CheckNames(absl::string_view what,
                        const std::vector<std::string>& names,
                        size_t max_bytes) {
  std::set<absl::string_view> seen;
  for (const std::string& name : names) {
    if (name.empty() || !TextFault(name, max_bytes).empty()) {
      return InvalidModel(what, Quoted(name),
                          absl::StrCat("1 to ", max_bytes,
                                       " bytes of UTF-8 without control "
                                       "characters"));
    }
    if (!seen.insert(name).second) {
      return InvalidModel(what, Quoted(name), "unique");
    }
  }
  return absl::OkStatus();
}

absl::Status CheckAnswers(const Question& question, size_t classes) {
  const std::string name = absl::StrCat("question ", question.name);
  if (question.kind != Question::kProperty &&
      question.kind != Question::kState) {
    return InvalidModel(absl::StrCat(name, " kind"),
                        static_cast<int>(question.kind),
                        "a property or a state");
  }
  if (question.values.size() < 2) {
    return InvalidModel(absl::StrCat(name, " number of values"),
                        question.values.size(), "at least 2");
  }
  TACTUS_RETURN_IF_ERROR(CheckNames(absl::StrCat(name, " value"),
                                    question.values,
                                    limits::kMaxTrialTextBytes));
  if (question.value_of_class.size() != classes) {
    return InvalidModel(absl::StrCat(name, " answers"),
                        question.value_of_class.size(),
                        absl::StrCat(classes, ", one per class"));
  }
  std::vector<bool> answered(question.values.size());
  for (const int value : question.value_of_class) {
    if (value < 0 || value >= static_cast<int>(answered.size())) {
      return InvalidModel(absl::StrCat(name, " answer"), value,
                          absl::StrCat("below ", answered.size()));
    }
    answered[value] = true;
  }
  const auto missing = std::ranges::find(answered, false);
  if (missing == answered.end()) return absl::OkStatus();
  return InvalidModel(absl::StrCat(name, " value"),
                      Quoted(question.values[missing - answered.begin()]),
                      "the answer of at least one class");
}

// Which of two values a class name has at one of its letters: HU, HM, SU, SM.
std::optional<int> LetterValue(const std::string& class_name, size_t letter) {
  constexpr absl::string_view kLetters[] = {"HS", "UM"};
  if (class_name.size() != 2) return std::nullopt;
  for (size_t i = 0; i < 2; ++i) {
    if (!absl::StrContains(kLetters[i], class_name[i])) return std::nullopt;
  }
  return static_cast<int>(kLetters[letter].find(class_name[letter]));
}

// Leaves the question out if all classes answer it alike.
void AddLetterQuestion(const std::vector<std::string>& class_names,
                       size_t letter, Question question,
                       std::vector<Question>& questions) {
  for (const std::string& name : class_names) {
    question.value_of_class.push_back(*LetterValue(name, letter));
  }
  const auto [least, most] = std::ranges::minmax(question.value_of_class);
  if (least != most) questions.push_back(std::move(question));
}

}  // namespace

absl::Status Validate(std::span<const Question> questions, size_t classes) {
  if (questions.empty() || questions.size() > limits::kMaxQuestions) {
    return InvalidModel("number of questions", questions.size(),
                        absl::StrCat("1 to ", limits::kMaxQuestions));
  }
  std::vector<std::string> names;
  for (const Question& question : questions) names.push_back(question.name);
  TACTUS_RETURN_IF_ERROR(
      CheckNames("question name", names, limits::kMaxQuestionNameBytes));
  for (const Question& question : questions) {
    if (absl::StrContains(question.name, ':')) {
      return InvalidModel("question name", Quoted(question.name),
                          "without a colon");
    }
    TACTUS_RETURN_IF_ERROR(CheckAnswers(question, classes));
  }
  return absl::OkStatus();
}

std::vector<Question> DefaultQuestions(
    const std::vector<std::string>& class_names) {
  std::vector<Question> questions;
  if (std::ranges::all_of(class_names, [](const std::string& name) {
        return LetterValue(name, 0).has_value();
      })) {
    AddLetterQuestion(class_names, 0,
                      {"hardness", Question::kProperty, {"hard", "soft"}, {}},
                      questions);
    AddLetterQuestion(class_names, 1,
                      {"mobility", Question::kState, {"unmoved", "moved"}, {}},
                      questions);
    return questions;
  }
  Question question = {"class", Question::kProperty, class_names, {}};
  for (size_t k = 0; k < class_names.size(); ++k) {
    question.value_of_class.push_back(static_cast<int>(k));
  }
  return {std::move(question)};
}

void ValueProbability(const Question& question,
                      std::span<const double> class_probability,
                      std::span<double> value_probability) {
  std::ranges::fill(value_probability, 0.0);
  for (size_t k = 0; k < class_probability.size(); ++k) {
    value_probability[question.value_of_class[k]] += class_probability[k];
  }
  // A sum may be rounded to more than 1.
  for (double& probability : value_probability) {
    probability = std::min(probability, 1.0);
  }
}

void SetValueProbability(const Question& question,
                         std::span<const double> value_probability,
                         std::span<double> class_probability) {
  const std::vector<int>& value_of = question.value_of_class;
  for (size_t v = 0; v < value_probability.size(); ++v) {
    double sum = 0;
    int classes = 0;
    for (size_t k = 0; k < value_of.size(); ++k) {
      if (value_of[k] != static_cast<int>(v)) continue;
      sum += class_probability[k];
      ++classes;
    }
    for (size_t k = 0; k < value_of.size(); ++k) {
      if (value_of[k] != static_cast<int>(v)) continue;
      class_probability[k] =
          sum > 0 ? class_probability[k] / sum * value_probability[v]
                  : value_probability[v] / classes;
    }
  }
}

}  // namespace tactus::internal
