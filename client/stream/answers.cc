#include "client/stream/answers.h"

#include <algorithm>

namespace tactus::internal::client {
namespace {

bool Fits(const v1::StreamStarted& started, const v1::Contact& contact,
          int class_index) {
  for (int q = 0; q < contact.answers_size(); ++q) {
    if (started.questions(q).value_of_class(class_index) !=
        contact.answers(q).decision().value()) {
      return false;
    }
  }
  return true;
}

}  // namespace

const v1::Contact* MainContact(const v1::Answer& answer) {
  return answer.contacts().empty() ? nullptr : &answer.contacts(0);
}

bool IsOpen(const v1::Contact& contact) {
  return contact.state() != v1::Contact::STATE_RELEASED;
}

int BestClass(const v1::Contact& contact) {
  const auto& p = contact.probability();
  return static_cast<int>(std::max_element(p.begin(), p.end()) - p.begin());
}

std::optional<DecidedClass> DecidedClassOf(const v1::StreamStarted& started,
                                           const v1::Contact& contact) {
  DecidedClass decided = {.class_index = -1};
  for (const v1::QuestionAnswer& answer : contact.answers()) {
    if (!answer.has_decision()) return std::nullopt;
    decided.time_since_onset_ns = std::max(
        {decided.time_since_onset_ns, answer.decision().time_since_onset_ns(),
         answer.decision().changed_time_since_onset_ns()});
  }
  for (int k = 0; k < started.class_names_size(); ++k) {
    if (!Fits(started, contact, k)) continue;
    if (decided.class_index >= 0) return std::nullopt;
    decided.class_index = k;
  }
  if (decided.class_index < 0) return std::nullopt;
  return decided;
}

}  // namespace tactus::internal::client
