// File: operation_removal.h
//
// Removes operations that have ended, with what belongs to them: the learning
// curve, the log, and the request ids that led to them. What a job made stays.
//
//   TACTUS_RETURN_IF_ERROR(RemoveOperation(change, operation));
//   TACTUS_ASSIGN_OR_RETURN(
//       const auto old, OldOperations(look, {.jobs = 1000}, now_ms, 100));
//
// Thread-safe: free functions without state.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/limits_training.h"
#include "core/store/catalog.h"
#include "tactus/v1/operations.pb.h"

namespace tactus::internal::server {

// True in the states SUCCEEDED, FAILED and CANCELLED.
bool HasEnded(const v1::Operation& operation);

// Which operations that have ended are kept; 0 means all.
struct Retention {
  // The newest of each client.
  int jobs = limits::kMaxKeptJobs;
  // Those that ended at most this long ago. The newest 100 of each client stay
  // however old they seem: a clock may be wrong.
  int64_t ms = limits::kKeptJobMs;
};

// Operations that are not to be kept, at most `limit`.
absl::StatusOr<std::vector<v1::Operation>> OldOperations(
    const Transaction& look, const Retention& retention, int64_t now_ms,
    size_t limit);

// `operation` has ended. Its number is never given again.
absl::Status RemoveOperation(Transaction& change,
                             const v1::Operation& operation);

}  // namespace tactus::internal::server
