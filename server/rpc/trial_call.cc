#include "server/rpc/trial_call.h"

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "server/ops/clock.h"
#include "server/rpc/status.h"

namespace tactus::internal::server {
namespace {

std::string Flatten(const grpc::ByteBuffer& buffer) {
  std::vector<grpc::Slice> slices;
  if (!buffer.Dump(&slices).ok()) return "";
  std::string bytes;
  bytes.reserve(buffer.Length());
  for (const grpc::Slice& slice : slices) {
    bytes.append(reinterpret_cast<const char*>(slice.begin()), slice.size());
  }
  return bytes;
}

}  // namespace

TrialCall::TrialCall(RawContactService* service, CallQueue* queue,
                     Delegate* delegate)
    : service_(service), delegate_(delegate), call_(queue) {
  service_->RequestClassifyTrial(call_.context(), &request_, &writer_,
                                 queue->queue(), queue->queue(), called_.tag());
}

void TrialCall::OnCalled(bool ok) {
  if (!ok) {
    // The server takes no more calls.
    delete this;
    return;
  }
  called_ns_ = MonotonicNs();
  delegate_->metrics()->rpcs.Start(kMethod);
  auto options = call_.Arrive([this] { return delegate_->Admit(this); });
  if (!options.ok()) {
    Finish(options.status());
    return;
  }
  answer_timeout_ms_ = options->idle_timeout_ms;
  trial_.emplace(delegate_->models(), *std::move(options), Flatten(request_));
  request_.Clear();
  queue()->Defer(&turn_);
}

void TrialCall::OnTurn(bool) {
  trial_->Step(delegate_->request(queue()));
  if (trial_->done()) {
    Finish(trial_->status());
  } else {
    queue()->Defer(&turn_);
  }
}

void TrialCall::Finish(const absl::Status& status) {
  code_ = status.code();
  if (answer_timeout_ms_ > 0) {
    ++in_flight_;
    answer_alarm_.Set(queue()->queue(),
                      std::chrono::system_clock::now() +
                          std::chrono::milliseconds(answer_timeout_ms_),
                      timeout_.tag());
  }
  ++in_flight_;
  if (!status.ok()) {
    writer_.FinishWithError(ToGrpcStatus(status), finished_.tag());
    return;
  }
  grpc::Slice bytes(trial_->response().SerializeAsString());
  writer_.Finish(grpc::ByteBuffer(&bytes, 1), grpc::Status::OK,
                 finished_.tag());
}

void TrialCall::OnFinished(bool ok) {
  --in_flight_;
  delivered_ = ok;
  delegate_->metrics()->rpcs.Handle(
      kMethod, ok ? code_ : absl::StatusCode::kCancelled,
      static_cast<double>(MonotonicNs() - called_ns_) * 1e-9);
  answer_alarm_.Cancel();
  DeleteIfOver();
}

void TrialCall::OnTimeout(bool ok) {
  --in_flight_;
  // The client takes not even the answer.
  if (ok) call_.context()->TryCancel();
  DeleteIfOver();
}

void TrialCall::DeleteIfOver() {
  if (in_flight_ > 0) return;
  if (trial_) delegate_->Release(this);
  delete this;
}

}  // namespace tactus::internal::server
