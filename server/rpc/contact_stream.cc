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
namespace {

int64_t TimeoutNs(const StreamSession::Options& options) {
  return options.idle_timeout_ms * int64_t{1'000'000};
}

}  // namespace

ContactStream::ContactStream(RawContactService* service, CallQueue* queue,
                             Keeper* keeper)
    : service_(service), queue_(queue), keeper_(keeper) {
  queue_->Enter();
  service_->RequestClassifyContact(&context_, &stream_, queue_->queue(),
                                   queue_->queue(), called_.tag());
}

ContactStream::~ContactStream() { queue_->Leave(); }

void ContactStream::OnCalled(bool ok) {
  if (!ok) {
    // The server takes no more calls.
    delete this;
    return;
  }
  auto options = keeper_->Admit(this);
  if (!options.ok()) {
    Finish(ToGrpcStatus(options.status()));
    return;
  }
  options_ = *std::move(options);
  session_.emplace(keeper_->models(), options_);
  last_read_ns_ = MonotonicNs();
  if (options_.idle_timeout_ms > 0) SetIdleAlarm(TimeoutNs(options_));
  Advance();
}

void ContactStream::Drain(uint32_t grace_ms) {
  session_->OnDraining(grace_ms);
  Advance();
}

void ContactStream::End(const absl::Status& status) {
  session_->Finish(status);
  Advance();
}

void ContactStream::OnRead(bool ok) {
  --in_flight_;
  reading_ = false;
  if (!finished_) {
    // A call that was cancelled looks like a half-close here; its writes fail.
    if (ok) {
      TakeMessage();
    } else {
      session_->OnHalfClose();
    }
  }
  Advance();
}

void ContactStream::TakeMessage() {
  const int64_t start_ns = MonotonicNs();
  last_read_ns_ = start_ns;
  const size_t size = read_.Length();
  grpc::ProtoBufferReader bytes(&read_);
  const absl::Status status = session_->OnMessage(&bytes, size);
  session_->EndRequest(start_ns, MonotonicNs());
  if (!status.ok()) {
    spdlog::debug("stream {}: {}", options_.stream_id, status.ToString());
  }
}

void ContactStream::OnWritten(bool ok) {
  --in_flight_;
  writing_ = false;
  session_->responses().FinishWrite();
  if (!ok) broken_ = true;
  Advance();
}

void ContactStream::Advance() {
  if (finished_) {
    DeleteIfOver();
    return;
  }
  if (!broken_) {
    if (!writing_) StartNextWrite();
    if (!reading_ && session_->wants_request()) {
      reading_ = true;
      ++in_flight_;
      stream_.Read(&read_, read_done_.tag());
    }
  }
  if (broken_) {
    Finish(grpc::Status::CANCELLED);
  } else if (session_->state() == StreamSession::State::kDone) {
    Finish(ToGrpcStatus(session_->final_status()));
  }
}

void ContactStream::StartNextWrite() {
  const v1::ClassifyContactResponse* response =
      session_->responses().StartWrite(MonotonicNs());
  if (response == nullptr) return;
  write_.Clear();
  bool own_buffer = false;
  grpc::SerializationTraits<v1::ClassifyContactResponse>::Serialize(
      *response, &write_, &own_buffer);
  writing_ = true;
  ++in_flight_;
  stream_.Write(write_, written_.tag());
}

void ContactStream::SetIdleAlarm(int64_t delay_ns) {
  ++in_flight_;
  idle_alarm_.Set(
      queue_->queue(),
      std::chrono::system_clock::now() + std::chrono::nanoseconds(delay_ns),
      idle_.tag());
}

void ContactStream::OnIdle(bool ok) {
  --in_flight_;
  if (!ok || finished_) {
    DeleteIfOver();
    return;
  }
  const int64_t left_ns = last_read_ns_ + TimeoutNs(options_) - MonotonicNs();
  if (left_ns > 0) {
    SetIdleAlarm(left_ns);
    return;
  }
  if (session_->state() == StreamSession::State::kFinishing) {
    // The peer takes not even what it is owed.
    context_.TryCancel();
    return;
  }
  SetIdleAlarm(TimeoutNs(options_));
  session_->Finish(StreamIdle(static_cast<int64_t>(options_.idle_timeout_ms)));
  Advance();
}

void ContactStream::Finish(const grpc::Status& status) {
  finished_ = true;
  ++in_flight_;
  stream_.Finish(status, finish_done_.tag());
  idle_alarm_.Cancel();
}

void ContactStream::OnFinished(bool) {
  --in_flight_;
  DeleteIfOver();
}

void ContactStream::DeleteIfOver() {
  if (!finished_ || in_flight_ > 0) return;
  if (session_) keeper_->Release(this);
  delete this;
}

}  // namespace tactus::server
