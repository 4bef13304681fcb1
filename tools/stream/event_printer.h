// File: event_printer.h
//
// tactus-stream --events: a line for each event of a stream, with the contact's
// number and the time since its onset.
//
//   EventPrinter printer(/*json=*/false);
//   LivePlayer player(channel, &driver, {.observer = &printer}, ...);
//
// event_line.h has their form.
#pragma once

#include <string>
#include <vector>

#include "tactus/v1/contact.pb.h"
#include "tools/stream/live_observer.h"

namespace tactus::internal::client {

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
