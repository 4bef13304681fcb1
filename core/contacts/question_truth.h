// File: question_truth.h
//
// QuestionTruth: the right answer to a question at each frame of a labelled
// contact. That of a property is the answer of the contact's label. That of a
// state is the answer of the label so far (LabelSoFar): an object is unmoved
// until it has moved by 1 mm. One that moved so far before it was felt has
// changed at frame 0.
//
//   const QuestionTruth truth(question, model.class_names, contact);
//   truth.at(0);      // the right value at the onset
//   truth.change();   // the first frame at which the object has changed
//
// Refers to its arguments, which must outlive it. Thread-safe.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/contacts/labelled_contact.h"
#include "core/questions/question.h"

namespace tactus::internal {

class QuestionTruth {
 public:
  // The contact's label must be one of the classes.
  QuestionTruth(const Question& question,
                const std::vector<std::string>& class_names,
                const LabelledContact& contact);

  // Index into Question::values. Frames count from 0.
  int at(size_t frame) const { return frame < changed_ ? first_ : final_; }
  int final_value() const { return final_; }
  // The first frame at which the answer is not that of an object at rest;
  // nothing if there is none.
  std::optional<size_t> change() const;
  // False for a state of a contact whose object's motion is unknown: then its
  // label is taken as the answer at every frame.
  bool history_known() const { return history_known_; }

 private:
  int first_ = 0;
  int final_ = 0;
  // Frames before this one have `first_`.
  size_t changed_ = 0;
  bool history_known_ = true;
};

}  // namespace tactus::internal
