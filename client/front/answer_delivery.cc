#include "client/front/answer_delivery.h"

namespace tactus::internal::client {

AnswerDelivery::AnswerDelivery(const StreamOptions& options)
    : on_answer_(options.on_answer),
      on_event_(options.on_event),
      on_notice_(options.on_notice) {}

void AnswerDelivery::Begin(const v1::StreamStarted& started) {
  converter_.emplace(started);
  has_begun_.store(true, std::memory_order_release);
}

void AnswerDelivery::OnResponse(const v1::ClassifyContactResponse& response) {
  if (response.has_answer()) {
    OnAnswer(response.answer());
  } else if (response.has_notice()) {
    OnNotice(response.notice());
  }
}

void AnswerDelivery::OnAnswer(const v1::Answer& answer) {
  if (!has_begun_.load(std::memory_order_acquire)) return;
  converter_->Convert(answer, answer_);
  Deliver(answer_);
}

void AnswerDelivery::Deliver(const Answer& answer) {
  for (const Event& event : answer.events) {
    if (on_event_) {
      on_event_(event);
    } else {
      events_.Add(event);
    }
  }
  if (on_answer_) on_answer_(answer);
}

void AnswerDelivery::OnNotice(const v1::StreamNotice& notice) {
  const std::optional<Notice> named = ToNotice(notice);
  if (named) Deliver(*named);
}

void AnswerDelivery::Deliver(const Notice& notice) {
  if (on_notice_) on_notice_(notice);
}

}  // namespace tactus::internal::client
