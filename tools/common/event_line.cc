#include "tools/common/event_line.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/strip.h"
#include "core/base/text.h"
#include "tools/common/json.h"

namespace tactus::internal::client {
namespace {

using v1::ContactEvent;

std::string WithCommas(int64_t count) {
  std::string text = absl::StrCat(count);
  for (int at = static_cast<int>(text.size()) - 3; at > 0; at -= 3) {
    text.insert(static_cast<size_t>(at), ",");
  }
  return text;
}

bool IsAboutQuestion(const ContactEvent& event) {
  return event.kind() == ContactEvent::KIND_DECIDED ||
         event.kind() == ContactEvent::KIND_CHANGED;
}

bool IsAboutOther(const ContactEvent& event) {
  return event.kind() == ContactEvent::KIND_MERGED ||
         event.kind() == ContactEvent::KIND_SPLIT;
}

// What people say of an object that begins to move, or is found at rest.
std::string ValueWords(const std::string& question, const std::string& value) {
  if (question == "mobility" && value == "moved") return "slipping";
  if (question == "mobility" && value == "unmoved") return "at rest";
  return Printable(value);
}

std::string Words(const ContactEvent& event, const v1::StreamStarted& started) {
  if (IsAboutQuestion(event)) {
    const v1::Question& question =
        started.questions(static_cast<int>(event.question()));
    const std::string words = ValueWords(
        question.name(), question.values(static_cast<int>(event.value())));
    return event.kind() == ContactEvent::KIND_CHANGED ? "now " + words : words;
  }
  switch (event.kind()) {
    case ContactEvent::KIND_TOUCHED:
      return "touched";
    case ContactEvent::KIND_RELEASED:
      return "let go";
    case ContactEvent::KIND_UNKNOWN:
      return "like nothing that the model has learned";
    case ContactEvent::KIND_MERGED:
      return absl::StrCat("joined contact ", event.other_id());
    case ContactEvent::KIND_SPLIT:
      return absl::StrCat("parted from contact ", event.other_id());
    case ContactEvent::KIND_MOVED_OVER_SKIN:
      return "moved over the skin";
    default:
      return "something that this program does not know";
  }
}

}  // namespace

std::string EventLine(const ContactEvent& event, int64_t ms,
                      const v1::StreamStarted& started, bool json) {
  if (!json) {
    return absl::StrFormat("contact %d  %s ms: %s", event.contact_id(),
                           WithCommas(ms), Words(event, started));
  }
  const std::string kind = ContactEvent::Kind_Name(event.kind());
  Json line = {{"contact", event.contact_id()},
               {"ms", ms},
               {"event", std::string(absl::StripPrefix(kind, "KIND_"))}};
  if (IsAboutQuestion(event)) {
    const v1::Question& question =
        started.questions(static_cast<int>(event.question()));
    line["question"] = question.name();
    line["value"] = question.values(static_cast<int>(event.value()));
  }
  if (IsAboutOther(event)) line["other"] = event.other_id();
  return JsonText(line);
}

}  // namespace tactus::internal::client
