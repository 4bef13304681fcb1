#include "tactus/mock.h"

#include <utility>

#include "client/front/answer_delivery.h"
#include "core/base/errors.h"

namespace tactus {

class MockStream::Impl {
 public:
  Impl(const StreamOptions& options, StreamInfo stream_info)
      : delivery(options), info(std::move(stream_info)) {}

  // Why a call fails; OK if it does not.
  absl::Status Refusal() const {
    if (!end.ok()) return end;
    return closed ? internal::StreamFinished() : absl::OkStatus();
  }

  internal::client::AnswerDelivery delivery;
  const StreamInfo info;
  std::vector<Frame> frames;
  Answer last;
  absl::Status end;
  int trials_ended = 0;
  bool closed = false;
  bool resuming = false;
};

MockStream::MockStream(const StreamOptions& options, StreamInfo info)
    : impl_(std::make_unique<Impl>(options, std::move(info))) {}
MockStream::~MockStream() = default;

void MockStream::Give(const Answer& answer) {
  impl_->last = answer;
  impl_->delivery.Deliver(answer);
}

void MockStream::Give(const Notice& notice) { impl_->delivery.Deliver(notice); }

void MockStream::Fail(absl::Status status) { impl_->end = std::move(status); }

void MockStream::SetResuming(bool resuming) { impl_->resuming = resuming; }

const std::vector<Frame>& MockStream::frames() const { return impl_->frames; }

int MockStream::trials_ended() const { return impl_->trials_ended; }

bool MockStream::closed() const { return impl_->closed; }

const StreamInfo& MockStream::info() const { return impl_->info; }

absl::Status MockStream::Push(const Frame& frame) {
  const absl::Status refusal = impl_->Refusal();
  if (refusal.ok()) impl_->frames.push_back(frame);
  return refusal;
}

absl::StatusOr<Answer> MockStream::EndTrial() {
  const absl::Status refusal = impl_->Refusal();
  if (!refusal.ok()) return refusal;
  ++impl_->trials_ended;
  Answer answer = std::exchange(impl_->last, {});
  answer.events.clear();
  answer.is_final = true;
  impl_->delivery.Deliver(answer);
  return answer;
}

absl::Status MockStream::Close() {
  impl_->closed = true;
  return impl_->end;
}

bool MockStream::Poll(Event& event) {
  return impl_->delivery.events().Poll(event);
}

bool MockStream::ended() { return !impl_->Refusal().ok(); }

bool MockStream::resuming() { return impl_->resuming; }

StreamStatistics MockStream::statistics() {
  StreamStatistics statistics;
  statistics.frames = impl_->frames.size();
  statistics.events_dropped = impl_->delivery.events().dropped();
  return statistics;
}

void MockStream::Cancel() { Fail(internal::WorkCancelled("the stream")); }

}  // namespace tactus
