// File: event_printer.h
//
// tactus-stream --events: a line for each event of a stream, with the contact's
// number and the time since its onset.
//
//   EventPrinter printer(/*json=*/false);
//   LivePlayer player(channel, &driver, {.observer = &printer}, ...);
//
// The lines are those that a robot's program gets of ToText (tactus/answer.h):
// "1540 ms: contact 2 changed mobility: moved". As JSON, each line is an object
// with `contact`, `ms`, `event`, and of those that are about a question
// `question` and `value`, of those about another contact `other`.
#pragma once

#include <optional>
#include <string>

#include "client/front/answer_convert.h"
#include "tactus/answer.h"
#include "tactus/v1/contact.pb.h"
#include "tools/stream/live_observer.h"

namespace tactus::client {

// {"contact":2,"event":"DECIDED","ms":120,...}
std::string EventJson(const Event& event);

class EventPrinter final : public LiveObserver {
 public:
  explicit EventPrinter(bool json) : json_(json) {}

  void OnStarted(const SkinInfo&, const v1::StreamStarted& started) override {
    converter_.emplace(started);
  }
  void OnFrame(const SkinFrame&, uint64_t) override {}
  // Prints the answer's events.
  void OnAnswer(const v1::Answer& answer) override;
  void OnRead() override {}

 private:
  const bool json_;
  std::optional<AnswerConverter> converter_;
  Answer answer_;
};

}  // namespace tactus::client
