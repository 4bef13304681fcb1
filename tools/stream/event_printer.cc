#include "tools/stream/event_printer.h"

#include <algorithm>
#include <cstdio>

#include "tools/common/event_line.h"

namespace tactus::internal::client {

void EventPrinter::OnAnswer(const v1::Answer& answer) {
  for (const v1::ContactEvent& event : answer.events()) {
    const auto contact = std::ranges::find(
        answer.contacts(), event.contact_id(), &v1::Contact::id);
    const int64_t ns =
        contact == answer.contacts().end() ? 0 : contact->time_since_onset_ns();
    std::printf("%s\n",
                EventLine(event, ns / 1'000'000, started_, json_).c_str());
  }
  if (answer.events_size() > 0) std::fflush(stdout);
}

}  // namespace tactus::internal::client
