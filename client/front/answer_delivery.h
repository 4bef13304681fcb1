// File: answer_delivery.h
//
// AnswerDelivery: hands the answers, events and notices of a stream to the
// callbacks of its options. Events wait to be polled if there is no callback
// for them.
//
//   AnswerDelivery delivery(options);
//   delivery.Begin(started);
//   delivery.OnResponse(response);
//   delivery.events().Poll(event);
//
// OnResponse belongs to one thread, which runs the callbacks. It may run before
// Begin: a server may only send notices then, and answers are left out.
#pragma once

#include <atomic>
#include <optional>

#include "client/front/answer_convert.h"
#include "client/front/event_queue.h"
#include "tactus/stream.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal::client {

class AnswerDelivery {
 public:
  explicit AnswerDelivery(const StreamOptions& options);

  void Begin(const v1::StreamStarted& started);
  void OnResponse(const v1::ClassifyContactResponse& response);
  void OnAnswer(const v1::Answer& answer);
  void OnNotice(const v1::StreamNotice& notice);
  // The same for what is no message; both need no Begin.
  void Deliver(const Answer& answer);
  void Deliver(const Notice& notice);

  // After Begin.
  const AnswerConverter& converter() const { return *converter_; }
  EventQueue& events() { return events_; }

 private:
  const std::function<void(const Answer&)> on_answer_;
  const std::function<void(const Event&)> on_event_;
  const std::function<void(const Notice&)> on_notice_;
  std::optional<AnswerConverter> converter_;
  std::atomic<bool> has_begun_ = false;
  // The callbacks' thread's; keeps its memory.
  Answer answer_;
  EventQueue events_;
};

}  // namespace tactus::internal::client
