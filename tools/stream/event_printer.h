// File: event_printer.h
//
// tactus-stream --events: a line for each event of a stream, with the contact's
// number and the time since its onset.
//
//   EventPrinter printer(/*json=*/false);
//   LivePlayer player(channel, &driver, {.observer = &printer}, ...);
//
// "contact 2  1,540 ms: slipping". As JSON, each line is an object with
// `contact`, `ms`, `event`, and of those that are about a question `question`
// and `value`, of those about another contact `other`.
#pragma once

#include <string>
#include <vector>

#include "tactus/v1/contact.pb.h"
#include "tools/stream/live_observer.h"

namespace tactus::internal::client {

// The line of `event`, which happened `ms` after the contact's onset.
std::string EventLine(const v1::ContactEvent& event, int64_t ms,
                      const v1::StreamStarted& started, bool json);

class EventPrinter final : public LiveObserver {
 public:
  explicit EventPrinter(bool json) : json_(json) {}

  void OnStarted(const SkinInfo&, const v1::StreamStarted& started) override {
    started_ = started;
  }
  void OnFrame(const SkinFrame&, uint64_t) override {}
  // Prints the answer's events.
  void OnAnswer(const v1::Answer& answer) override;
  void OnRead() override {}

 private:
  const bool json_;
  v1::StreamStarted started_;
};

}  // namespace tactus::internal::client
