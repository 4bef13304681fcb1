#include "core/contacts/question_truth.h"

#include <algorithm>

namespace tactus::internal {

QuestionTruth::QuestionTruth(const Question& question,
                             const std::vector<std::string>& class_names,
                             const LabelledContact& contact) {
  const auto answer_of = [&](const std::string& label, int otherwise) {
    const auto found = std::ranges::find(class_names, label);
    return found == class_names.end()
               ? otherwise
               : question.value_of_class[found - class_names.begin()];
  };
  final_ = first_ = answer_of(contact.label, 0);
  if (question.kind == Question::kProperty) return;
  history_known_ = !contact.object_motion.empty();
  if (!history_known_) return;
  // The model may have no class for an object that has not moved yet.
  const auto value = [&](size_t frame) {
    return answer_of(LabelSoFar(contact, frame), final_);
  };
  const size_t frames = contact.frames.size();
  first_ = answer_of(LabelAtRest(contact.label), final_);
  while (changed_ < frames && value(changed_) == first_) ++changed_;
  // An object that moves back is still a moved one.
  if (changed_ == frames) final_ = first_;
}

std::optional<size_t> QuestionTruth::change() const {
  if (first_ == final_) return std::nullopt;
  return changed_;
}

}  // namespace tactus::internal
