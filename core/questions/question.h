// File: question.h
//
// Question: what a robot wants to know of a contact, as sums over the classes
// of a model. The classes HU, HM, SU, SM answer "hardness" with hard or soft,
// and "mobility" with unmoved or moved.
//
//   const std::vector<std::string> classes = {"HU", "HM", "SU", "SM"};
//   const std::vector<Question> questions = DefaultQuestions(classes);
//   const double posterior[] = {0.1, 0.6, 0.1, 0.2};
//   double value[2];
//   ValueProbability(questions[0], posterior, value);  // hard 0.7, soft 0.3
//
// Plain data and free functions without state; thread-safe.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "absl/status/status.h"

namespace tactus::internal {

struct Question {
  enum Kind {
    // The same from the onset to the end of a contact.
    kProperty,
    // May change during a contact.
    kState,
  };
  std::string name;
  Kind kind = kProperty;
  std::vector<std::string> values;
  // [classes] Index into `values`, in the order of the model's classes.
  std::vector<int> value_of_class;
};

// INVALID_MODEL unless there are 1 to limits::kMaxQuestions questions with
// unique names of 1 to limits::kMaxQuestionNameBytes bytes without a colon, and
// each has at least two values with unique names, each value is the answer of
// some class, and each of the `classes` classes has a value.
absl::Status Validate(std::span<const Question> questions, size_t classes);

// The questions of models that name none. "hardness" (a property) and
// "mobility" (a state) if all classes are among HU, HM, SU, SM; a question that
// all classes answer alike is left out. For other classes one property,
// "class", whose values are the classes. There must be two classes or more.
std::vector<Question> DefaultQuestions(
    const std::vector<std::string>& class_names);

// Sets `value_probability` (one per value) to the sums of the probabilities of
// the classes that answer with each value, at most 1. Allocates nothing.
void ValueProbability(const Question& question,
                      std::span<const double> class_probability,
                      std::span<double> value_probability);

// The reverse: scales the probabilities of the classes that answer with each
// value, so that they sum to its `value_probability`. Classes without any share
// it evenly. Allocates nothing.
void SetValueProbability(const Question& question,
                         std::span<const double> value_probability,
                         std::span<double> class_probability);

}  // namespace tactus::internal
