#include "server/rpc/control_call.h"

#include <chrono>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "server/ops/clock.h"
#include "server/rpc/control_service.h"
#include "server/rpc/status.h"

namespace tactus::internal::server {

ControlCall::ControlCall(ControlService* service, CallQueue* queue)
    : service_(service), call_(queue) {
  // Its event comes only for a call that begins.
  call_.context()->AsyncNotifyWhenDone(gone_.tag());
  service_->generic()->RequestCall(call_.context(), &stream_, queue->queue(),
                                   queue->queue(), called_.tag());
}

void ControlCall::OnCalled(bool ok) {
  if (!ok) {
    delete this;
    return;
  }
  new ControlCall(service_, call_.queue());
  called_ns_ = MonotonicNs();
  service_->rpcs()->Start(method());
  // The event OnGone is still to come, and that of Finish.
  in_flight_ = 2;
  const absl::Status status =
      call_.Arrive([&] { return service_->Admit(this, &caller_); });
  if (!status.ok()) {
    Finish(status);
    return;
  }
  admitted_ = true;
  service_->Run(this);
}

void ControlCall::Work() {
  const absl::Status status = service_->Handle(method(), *this);
  {
    const std::lock_guard lock(mutex_);
    left_ = moving_;
    // Finish ends the read, and its event is one more to come.
    if (left_) ++in_flight_;
  }
  Finish(status);
}

void ControlCall::Finish(const absl::Status& status) {
  code_ = status.code();
  stream_.Finish(ToGrpcStatus(status), finish_done_.tag());
}

void ControlCall::StartRead() {
  {
    const std::lock_guard lock(mutex_);
    moving_ = true;
  }
  reading_ahead_ = true;
  stream_.Read(&ahead_, moved_.tag());
}

absl::Status ControlCall::Read(grpc::ByteBuffer* message, bool* more) {
  if (!reading_ahead_) StartRead();
  *more = AwaitMove();
  reading_ahead_ = false;
  message->Swap(&ahead_);
  ahead_.Clear();
  if (*more) return absl::OkStatus();
  const std::lock_guard lock(mutex_);
  if (timed_out_) return StreamIdle(limits::kControlTimeoutMs);
  return is_gone_ ? WorkCancelled("the call") : absl::OkStatus();
}

absl::Status ControlCall::Write(const grpc::ByteBuffer& message) {
  {
    const std::lock_guard lock(mutex_);
    moving_ = true;
  }
  stream_.Write(message, moved_.tag());
  if (AwaitMove()) return absl::OkStatus();
  const std::lock_guard lock(mutex_);
  return timed_out_ ? StreamIdle(limits::kControlTimeoutMs)
                    : WorkCancelled("the call");
}

bool ControlCall::AwaitMove() {
  std::unique_lock lock(mutex_);
  const auto done = [this] { return !moving_; };
  if (!changed_.wait_for(
          lock, std::chrono::milliseconds(limits::kControlTimeoutMs), done)) {
    timed_out_ = true;
    call_.context()->TryCancel();
    // A cancelled call completes its operations at once.
    changed_.wait(lock, done);
  }
  return move_ok_ && !timed_out_;
}

bool ControlCall::IsCancelled() const {
  const std::lock_guard lock(mutex_);
  return is_gone_ || service_->draining();
}

void ControlCall::OnMoved(bool ok) {
  bool left = false;
  {
    const std::lock_guard lock(mutex_);
    moving_ = false;
    move_ok_ = ok;
    left = left_;
    changed_.notify_all();
  }
  if (left) EndOperation();
}

void ControlCall::OnGone(bool) {
  {
    const std::lock_guard lock(mutex_);
    is_gone_ = call_.context()->IsCancelled();
  }
  EndOperation();
}

void ControlCall::OnFinished(bool ok) {
  service_->rpcs()->Handle(
      method(), ok ? code_ : absl::StatusCode::kCancelled,
      static_cast<double>(MonotonicNs() - called_ns_) * 1e-9);
  if (admitted_) service_->Release(this);
  EndOperation();
}

void ControlCall::EndOperation() {
  if (--in_flight_ == 0) delete this;
}

}  // namespace tactus::internal::server
