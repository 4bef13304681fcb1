#include "client/training/retry.h"

#include <thread>
#include <utility>

namespace tactus::internal::client {

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

}  // namespace tactus::internal::client
