#include "server/rpc/contact_stream.h"

#include <chrono>
#include <utility>

#include "core/base/errors.h"
#include "grpcpp/impl/codegen/proto_utils.h"
#include "grpcpp/support/proto_buffer_reader.h"
#include "server/ops/clock.h"
#include "server/rpc/status.h"
#include "spdlog/spdlog.h"

namespace tactus::server {

ContactStream::ContactStream(grpc::CallbackServerContext* context,
                             const ModelSource* models, Options options)
    : context_(context),
      options_(std::move(options)),
      session_(models, options_.session) {}

void ContactStream::Start() {
  self_ = shared_from_this();
  const std::lock_guard lock(mutex_);
  last_read_ns_ = MonotonicNs();
  if (options_.idle_timeout_ms > 0) {
    SetIdleAlarm(options_.idle_timeout_ms * int64_t{1'000'000});
  }
  Advance();
}

void ContactStream::Drain(uint32_t grace_ms) {
  const std::lock_guard lock(mutex_);
  session_.OnDraining(grace_ms);
  Advance();
}

void ContactStream::End(const absl::Status& status) {
  const std::lock_guard lock(mutex_);
  session_.Finish(status);
  Advance();
}

void ContactStream::OnReadDone(bool ok) {
  const std::lock_guard lock(mutex_);
  reading_ = false;
  if (ok) {
    TakeMessage();
  } else if (context_->IsCancelled()) {
    broken_ = true;
  } else {
    session_.OnHalfClose();
  }
  Advance();
}

void ContactStream::TakeMessage() {
  const int64_t start_ns = MonotonicNs();
  last_read_ns_ = start_ns;
  const size_t size = read_.Length();
  grpc::ProtoBufferReader bytes(&read_);
  const absl::Status status = session_.OnMessage(&bytes, size);
  session_.EndRequest(start_ns, MonotonicNs());
  if (!status.ok()) {
    spdlog::debug("stream {}: {}", options_.session.stream_id,
                  status.ToString());
  }
}

void ContactStream::OnWriteDone(bool ok) {
  const std::lock_guard lock(mutex_);
  writing_ = false;
  session_.responses().FinishWrite();
  if (!ok) broken_ = true;
  Advance();
}

void ContactStream::OnCancel() {
  const std::lock_guard lock(mutex_);
  broken_ = true;
  Advance();
}

void ContactStream::Advance() {
  if (finished_) return;
  if (!broken_) {
    if (!writing_) StartNextWrite();
    if (!reading_ && session_.wants_request()) {
      reading_ = true;
      StartRead(&read_);
    }
  }
  const bool over =
      broken_ ? !writing_ : session_.state() == StreamSession::State::kDone;
  if (!over) return;
  finished_ = true;
  if (idle_alarm_ != nullptr) idle_alarm_->Cancel();
  Finish(broken_ ? grpc::Status::CANCELLED
                 : ToGrpcStatus(session_.final_status()));
}

void ContactStream::StartNextWrite() {
  const v1::ClassifyContactResponse* response =
      session_.responses().StartWrite(MonotonicNs());
  if (response == nullptr) return;
  write_.Clear();
  bool own_buffer = false;
  grpc::SerializationTraits<v1::ClassifyContactResponse>::Serialize(
      *response, &write_, &own_buffer);
  writing_ = true;
  StartWrite(&write_);
}

void ContactStream::SetIdleAlarm(int64_t delay_ns) {
  // A new one each time: the old one may be running its callback.
  idle_alarm_ = std::make_unique<grpc::Alarm>();
  idle_alarm_->Set(
      std::chrono::system_clock::now() + std::chrono::nanoseconds(delay_ns),
      // Weak: the stream owns the alarm, which keeps this until it is deleted.
      [weak = weak_from_this()](bool expired) {
        const auto self = weak.lock();
        if (expired && self != nullptr) self->OnIdleAlarm();
      });
}

void ContactStream::OnIdleAlarm() {
  const std::lock_guard lock(mutex_);
  if (finished_) return;
  const int64_t timeout_ns = options_.idle_timeout_ms * int64_t{1'000'000};
  const int64_t left_ns = last_read_ns_ + timeout_ns - MonotonicNs();
  if (left_ns > 0) {
    SetIdleAlarm(left_ns);
    return;
  }
  if (session_.state() == StreamSession::State::kFinishing) {
    // The peer takes not even what it is owed.
    context_->TryCancel();
    return;
  }
  session_.Finish(StreamIdle(options_.idle_timeout_ms));
  Advance();
  if (!finished_) SetIdleAlarm(timeout_ns);
}

void ContactStream::OnDone() {
  options_.on_done(this);
  // May be the last share: touch nothing afterwards.
  self_.reset();
}

}  // namespace tactus::server
