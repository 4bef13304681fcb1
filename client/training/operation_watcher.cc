#include "client/training/operation_watcher.h"

#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/crc32c.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"

namespace tactus::internal::client {

bool HasEnded(const v1::Operation& operation) {
  return operation.state() == v1::Operation::STATE_SUCCEEDED ||
         operation.state() == v1::Operation::STATE_FAILED ||
         operation.state() == v1::Operation::STATE_CANCELLED;
}

OperationWatcher::OperationWatcher(TrainingClient* client, RetryOptions retry)
    : client_(client), retry_(std::move(retry)) {}

absl::StatusOr<v1::Operation> OperationWatcher::Watch(
    const std::string& name, const OnUpdate& on_update) {
  last_.Clear();
  points_ = 0;
  Retries retries(retry_, ExtendCrc32c(0, name));
  bool connected = false;
  for (;;) {
    last_.Clear();
    const absl::Status status = WatchOnce(name, on_update);
    if (HasEnded(last_)) return last_;
    {
      const std::lock_guard lock(mutex_);
      if (cancelled_) return absl::CancelledError("the watch was cancelled");
    }
    if (!last_.name().empty()) {
      connected = true;
      retries.Reset();
    }
    // A server that has never answered is not waited for.
    TACTUS_RETURN_IF_ERROR(
        retries.WaitIf(connected && MayRetry(status), status));
  }
}

absl::Status OperationWatcher::WatchOnce(const std::string& name,
                                         const OnUpdate& on_update) {
  v1::WatchOperationRequest request;
  request.set_name(name);
  // Without a deadline: the channel's keep-alive notices a server that is gone.
  const auto context = client_->NewContext(std::chrono::milliseconds(0));
  {
    const std::lock_guard lock(mutex_);
    if (cancelled_) return absl::OkStatus();
    context_ = context.get();
  }
  const auto reader =
      client_->operations().WatchOperation(context.get(), request);
  absl::Status broken;
  v1::WatchOperationResponse response;
  // The server sends the curve from its beginning on each call.
  size_t known = points_;
  while (!HasEnded(last_) && reader->Read(&response)) {
    if (response.operation().name() != name) {
      broken = InvalidResponse(
          "operation.name", Quoted(response.operation().name()), Quoted(name));
      context->TryCancel();
      break;
    }
    last_ = std::move(*response.mutable_operation());
    std::vector<v1::LearningPoint> points;
    for (v1::LearningPoint& point : *response.mutable_points()) {
      if (known > 0) {
        --known;
      } else {
        points.push_back(std::move(point));
        ++points_;
      }
    }
    on_update(last_, points);
  }
  grpc::Status status = reader->Finish();
  {
    const std::lock_guard lock(mutex_);
    context_ = nullptr;
  }
  if (!broken.ok()) return broken;
  if (!status.ok())
    return TrainingClient::ErrorOf(status, "WatchOperation", {});
  if (HasEnded(last_)) return absl::OkStatus();
  return InvalidResponse("end of the watch",
                         v1::Operation::State_Name(last_.state()),
                         "a state in which the job has ended");
}

void OperationWatcher::Cancel() {
  const std::lock_guard lock(mutex_);
  cancelled_ = true;
  if (context_ != nullptr) context_->TryCancel();
}

}  // namespace tactus::internal::client
