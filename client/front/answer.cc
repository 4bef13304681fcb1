#include "tactus/answer.h"

#include "absl/strings/str_cat.h"

namespace tactus {
namespace {

constexpr int64_t kNsPerMs = 1'000'000;

const QuestionAnswer* FindAnswer(const Contact& contact,
                                 std::string_view question) {
  for (const QuestionAnswer& answer : contact.answers) {
    if (answer.question == question) return &answer;
  }
  return nullptr;
}

}  // namespace

double Contact::Probability(std::string_view question,
                            std::string_view value) const {
  const QuestionAnswer* const answer = FindAnswer(*this, question);
  if (answer == nullptr) return 0;
  for (const NamedProbability& named : answer->values) {
    if (named.name == value) return named.probability;
  }
  return 0;
}

std::string_view Contact::Decided(std::string_view question) const {
  const QuestionAnswer* const answer = FindAnswer(*this, question);
  if (answer == nullptr || !answer->decided) return {};
  return answer->decided->value;
}

std::string_view ToText(EventKind kind) {
  switch (kind) {
    case EventKind::kTouched:
      return "touched";
    case EventKind::kReleased:
      return "released";
    case EventKind::kDecided:
      return "decided";
    case EventKind::kChanged:
      return "changed";
    case EventKind::kUnknown:
      return "unknown";
    case EventKind::kMerged:
      return "merged";
    case EventKind::kSplit:
      return "split";
    case EventKind::kMovedOverSkin:
      return "moved over skin";
  }
  return "";
}

std::string ToText(const Event& event) {
  std::string text =
      absl::StrCat(event.since_onset_ns / kNsPerMs, " ms: contact ",
                   event.contact, " ", std::string(ToText(event.kind)));
  if (!event.question.empty()) {
    absl::StrAppend(&text, " ", event.question, ": ", event.value);
  }
  if (event.other_contact != 0) {
    absl::StrAppend(&text,
                    event.kind == EventKind::kMerged ? " into " : " from ",
                    "contact ", event.other_contact);
  }
  return text;
}

}  // namespace tactus
