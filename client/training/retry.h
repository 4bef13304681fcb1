// File: retry.h
//
// Which failed calls a client repeats by itself, and how often.
//
//   Retries retries({}, /*seed=*/1);
//   for (;;) {
//     const absl::Status status = Send();
//     if (status.ok()) return status;
//     TACTUS_RETURN_IF_ERROR(retries.Wait(status));
//   }
//
// Not thread-safe.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>

#include "absl/status/status.h"
#include "client/stream/backoff.h"
#include "client/stream/status.h"

namespace tactus::internal::client {

struct RetryOptions {
  // Failures in a row, without progress between them, that are repeated. Ten
  // take 8 to 16 s: a server restarts in this time.
  int limit = 10;
  // Waits; tests replace it.
  std::function<void(std::chrono::milliseconds)> sleep = {};
};

class Retries {
 public:
  Retries(RetryOptions options, uint64_t seed);

  // Waits and returns OK if the call that ended with `status` is to be
  // repeated; else returns `status`.
  absl::Status Wait(const absl::Status& status);
  // The same for a caller that knows whether the call may be repeated.
  absl::Status WaitIf(bool may_retry, const absl::Status& status);
  // The server made progress: failures are counted from 0 again.
  void Reset();

 private:
  const RetryOptions options_;
  Backoff backoff_;
  int failures_ = 0;
};

// Repeats a call that has the same effect however often it arrives, e.g. one
// with a request_id. `call` returns an absl::StatusOr.
template <typename Call>
auto Repeated(const RetryOptions& options, const Call& call)
    -> decltype(call()) {
  Retries retries(options, /*seed=*/1);
  for (;;) {
    auto result = call();
    if (result.ok()) return result;
    absl::Status status = retries.Wait(result.status());
    if (!status.ok()) return status;
  }
}

}  // namespace tactus::internal::client
