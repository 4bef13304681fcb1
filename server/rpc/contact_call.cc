#include "server/rpc/contact_call.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/base/errors.h"
#include "grpcpp/impl/codegen/proto_utils.h"
#include "grpcpp/support/proto_buffer_reader.h"
#include "server/ops/clock.h"
#include "server/records/caller.h"
#include "server/rpc/status.h"

namespace tactus::internal::server {
namespace {

// Lost frames of a message that are counted: a sequence number may jump by any
// distance, and one robot must not make the sum of all useless.
constexpr uint64_t kMostMissing = 1'000'000;

double Seconds(int64_t ns) { return static_cast<double>(ns) * 1e-9; }

}  // namespace

ContactCall::ContactCall(RawContactService* service, CallQueue* queue,
                         Delegate* delegate)
    : service_(service), delegate_(delegate), call_(queue) {
  service_->RequestClassifyContact(call_.context(), &stream_, queue->queue(),
                                   queue->queue(), called_.tag());
}

void ContactCall::OnCalled(bool ok) {
  if (!ok) {
    // The server takes no more calls.
    delete this;
    return;
  }
  called_ns_ = MonotonicNs();
  delegate_->metrics()->rpcs.Start(kMethod);
  metrics_ = delegate_->lane_metrics(queue());
  auto options = call_.Arrive([this] { return delegate_->Admit(this); });
  if (!options.ok()) {
    Finish(ToGrpcStatus(options.status()));
    return;
  }
  options_ = *std::move(options);
  request_ = delegate_->request(queue());
  session_.emplace(delegate_->models(), options_);
  last_read_ns_ = MonotonicNs();
  if (TimeoutMs() > 0) SetIdleAlarm(TimeoutMs() * kNsPerMs);
  Advance();
}

void ContactCall::Drain(uint32_t grace_ms) {
  session_->OnDraining(grace_ms);
  Advance();
}

void ContactCall::End(const absl::Status& status) {
  session_->Finish(status);
  Advance();
}

void ContactCall::OnRead(bool ok) {
  --in_flight_;
  reading_ = false;
  if (!finished_) {
    // A call that was cancelled looks like a half-close here; its writes fail.
    pacing_.OnReadEnded(ok, writing_);
    if (ok) {
      // Before it would give way to the answer of this message.
      if (pacing_.held() && !writing_ && session_->responses().size() > 0) {
        StageNextWrite();
      }
      TakeMessage();
    } else {
      session_->OnHalfClose();
    }
  }
  Advance();
}

void ContactCall::TakeMessage() {
  const int64_t start_ns = MonotonicNs();
  last_read_ns_ = start_ns;
  const size_t size = read_.Length();
  grpc::ProtoBufferReader bytes(&read_);
  WatchedStream* watched = observers_.watched;
  if (watched != nullptr) watched->BeginMessage(start_ns);
  // An error ends the stream, and the line about its end shows it.
  const bool taken = session_->OnMessage(&bytes, size, request_).ok();
  const int64_t end_ns = MonotonicNs();
  session_->EndRequest(start_ns, end_ns);
  metrics_->messages_received.fetch_add(1, std::memory_order_relaxed);
  if (session_->contacts() == nullptr) return;
  if (watched == nullptr) Open();
  Observe(start_ns, end_ns);
  if (taken && observers_.recorder != nullptr) {
    observers_.recorder->EndMessage(
        request_->has_frames() ? &request_->frames() : nullptr, SystemNowMs());
  }
}

void ContactCall::Open() {
  observers_ = delegate_->Open(this);
  if (observers_.recorder == nullptr) {
    session_->SetTap(observers_.watched);
    return;
  }
  taps_.emplace(observers_.watched, observers_.recorder.get());
  session_->SetTap(&*taps_);
}

void ContactCall::Observe(int64_t start_ns, int64_t end_ns) {
  const ContactSession& contacts = *session_->contacts();
  const WatchedStream::Counts now = {
      .frames = contacts.frames(),
      .frames_missing = contacts.frames_missing(),
      .superseded = session_->responses().superseded(),
      .contacts = contacts.contacts_begun(),
      .contacts_now = contacts.contacts_now()};
  observers_.watched->EndMessage(now, end_ns);
  const uint64_t frames = now.frames - counts_.frames;
  if (frames > 0) {
    constexpr auto kRelaxed = std::memory_order_relaxed;
    metrics_->frames.fetch_add(frames, kRelaxed);
    metrics_->frames_missing.fetch_add(
        std::min(now.frames_missing - counts_.frames_missing, kMostMissing),
        kRelaxed);
    metrics_->superseded.fetch_add(now.superseded - counts_.superseded,
                                   kRelaxed);
    metrics_->processing.Observe(
        Seconds(end_ns - start_ns) / static_cast<double>(frames), frames);
  }
  counts_ = now;
}

void ContactCall::OnNothingMore(bool idle) {
  --in_flight_;
  pacing_.EndHold(idle);
  Advance();
}

void ContactCall::OnWritten(bool ok) {
  --in_flight_;
  writing_ = false;
  session_->responses().FinishWrite();
  if (!ok) broken_ = true;
  Advance();
}

void ContactCall::Advance() {
  if (finished_) {
    DeleteIfOver();
    return;
  }
  if (!broken_) {
    if (pacing_.ReadsFirst()) StartNextRead();
    if (staged_) StartStagedWrite();
    if (!writing_ && session_->responses().size() > 0) {
      if (pacing_.Holds(reading_)) {
        Hold();
      } else {
        StageNextWrite();
        StartStagedWrite();
      }
    }
    StartNextRead();
  }
  if (broken_) {
    Finish(grpc::Status::CANCELLED);
  } else if (session_->state() == StreamSession::State::kDone) {
    Finish(ToGrpcStatus(session_->final_status()));
  }
}

void ContactCall::StartNextRead() {
  if (reading_ || !session_->wants_request()) return;
  reading_ = true;
  pacing_.OnReadStarted();
  ++in_flight_;
  stream_.Read(&read_, read_done_.tag());
}

void ContactCall::StageNextWrite() {
  const v1::ClassifyContactResponse& response =
      *session_->responses().StartWrite(MonotonicNs());
  metrics_->messages_sent.fetch_add(1, std::memory_order_relaxed);
  if (response.has_answer()) {
    metrics_->waiting.Observe(Seconds(session_->responses().waited_ns()));
    AnswerMetrics::Count(response.answer(), observers_.series);
  }
  grpc::Slice bytes(response.ByteSizeLong());
  // Slices are const only once they are shared.
  response.SerializeWithCachedSizesToArray(const_cast<uint8_t*>(bytes.begin()));
  grpc::ByteBuffer message(&bytes, 1);
  write_.Swap(&message);
  staged_ = true;
}

void ContactCall::StartStagedWrite() {
  staged_ = false;
  writing_ = true;
  ++in_flight_;
  grpc::WriteOptions options;
  const bool more = session_->responses().size() > 0;
  if (!pacing_.Flushes(more)) options.set_buffer_hint();
  stream_.Write(write_, options, written_.tag());
}

void ContactCall::Hold() {
  if (!pacing_.BeginHold()) return;
  ++in_flight_;
  queue()->Defer(&nothing_more_);
}

int ContactCall::TimeoutMs() const {
  const int idle_ms = static_cast<int>(options_.idle_timeout_ms);
  const int first_ms = delegate_->first_message_timeout_ms();
  if (session_->state() != StreamSession::State::kWaitConfig || first_ms == 0) {
    return idle_ms;
  }
  return idle_ms == 0 ? first_ms : std::min(first_ms, idle_ms);
}

void ContactCall::SetIdleAlarm(int64_t delay_ns) {
  ++in_flight_;
  idle_alarm_.Set(
      queue()->queue(),
      std::chrono::system_clock::now() + std::chrono::nanoseconds(delay_ns),
      idle_.tag());
}

void ContactCall::OnIdle(bool ok) {
  --in_flight_;
  if (!ok || finished_) {
    DeleteIfOver();
    return;
  }
  const int timeout_ms = TimeoutMs();
  // The first message came, and silence after it has no limit.
  if (timeout_ms == 0) return;
  const int64_t left_ns = last_read_ns_ + timeout_ms * kNsPerMs - MonotonicNs();
  if (left_ns > 0) {
    SetIdleAlarm(left_ns);
    return;
  }
  if (session_->state() == StreamSession::State::kFinishing) {
    // The peer takes not even what it is owed.
    call_.context()->TryCancel();
    return;
  }
  const bool waits_for_config =
      session_->state() == StreamSession::State::kWaitConfig;
  SetIdleAlarm(timeout_ms * kNsPerMs);
  session_->Finish(waits_for_config ? NoFirstMessage(timeout_ms)
                                    : StreamIdle(timeout_ms));
  Advance();
}

void ContactCall::Finish(const grpc::Status& status) {
  finished_ = true;
  code_ = status.error_code();
  ++in_flight_;
  stream_.Finish(status, finish_done_.tag());
  idle_alarm_.Cancel();
}

void ContactCall::OnFinished(bool ok) {
  --in_flight_;
  delivered_ = ok && !broken_;
  delegate_->metrics()->rpcs.Handle(kMethod,
                                    delivered_
                                        ? static_cast<absl::StatusCode>(code_)
                                        : absl::StatusCode::kCancelled,
                                    Seconds(MonotonicNs() - called_ns_));
  DeleteIfOver();
}

void ContactCall::DeleteIfOver() {
  if (!finished_ || in_flight_ > 0) return;
  if (observers_.recorder != nullptr) {
    observers_.recorder->EndStream(SystemNowMs());
  }
  if (session_) delegate_->Release(this);
  delete this;
}

}  // namespace tactus::internal::server
