#include "tools/stream/event_printer.h"

#include <cstdio>

#include "absl/strings/ascii.h"
#include "absl/strings/str_replace.h"
#include "core/base/text.h"
#include "tools/common/json.h"

namespace tactus::client {

std::string EventJson(const Event& event) {
  const std::string kind =
      absl::AsciiStrToUpper(std::string(ToText(event.kind)));
  Json line = {{"contact", event.contact},
               {"ms", event.since_onset_ns / 1'000'000},
               {"event", absl::StrReplaceAll(kind, {{" ", "_"}})}};
  if (!event.question.empty()) {
    line["question"] = event.question;
    line["value"] = event.value;
  }
  if (event.other_contact != 0) line["other"] = event.other_contact;
  return JsonText(line);
}

void EventPrinter::OnAnswer(const v1::Answer& answer) {
  converter_->Convert(answer, answer_);
  for (const Event& event : answer_.events) {
    std::printf("%s\n", json_ ? EventJson(event).c_str()
                              : Printable(ToText(event)).c_str());
  }
  if (!answer_.events.empty()) std::fflush(stdout);
}

}  // namespace tactus::client
