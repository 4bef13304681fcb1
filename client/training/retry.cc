#include "client/training/retry.h"

#include <thread>
#include <utility>

#include "core/base/errors.h"

namespace tactus::client {

bool MayRetry(const absl::Status& status) {
  const std::string reason = ReasonOf(status);
  switch (status.code()) {
    case absl::StatusCode::kUnavailable:
      return true;
    case absl::StatusCode::kAborted:
      return reason == "UPLOAD_BUSY";
    case absl::StatusCode::kDeadlineExceeded:
      return reason.empty() || reason == "NO_RESPONSE";
    case absl::StatusCode::kCancelled:
    case absl::StatusCode::kInternal:
    case absl::StatusCode::kUnknown:
      // gRPC reports broken connections and streams with these.
      return reason.empty();
    default:
      return false;
  }
}

Retries::Retries(RetryOptions options, uint64_t seed)
    : options_(std::move(options)), backoff_(seed) {}

absl::Status Retries::Wait(const absl::Status& status) {
  return WaitIf(MayRetry(status), status);
}

absl::Status Retries::WaitIf(bool may_retry, const absl::Status& status) {
  if (!may_retry || failures_ >= options_.limit) return status;
  ++failures_;
  const std::chrono::milliseconds wait = backoff_.Next();
  if (options_.sleep) {
    options_.sleep(wait);
  } else {
    std::this_thread::sleep_for(wait);
  }
  return absl::OkStatus();
}

void Retries::Reset() {
  failures_ = 0;
  backoff_.Reset();
}

}  // namespace tactus::client
