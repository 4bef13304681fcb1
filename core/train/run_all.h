// File: run_all.h
//
// Work that may fail, on lent threads.
//
//   TACTUS_RETURN_IF_ERROR(
//       RunAll(parallel, 3, [&](int i) { return Fit(i); }));
//
// Thread-safe: a free function without state.
#pragma once

#include <functional>
#include <vector>

#include "absl/status/status.h"
#include "core/base/status_macros.h"
#include "core/base/work.h"

namespace tactus::internal {

// Runs all bodies and returns the first error in their order.
inline absl::Status RunAll(const ParallelFor& parallel, size_t count,
                           const std::function<absl::Status(int)>& body) {
  std::vector<absl::Status> failures(count);
  parallel(static_cast<int>(count), [&](int i) { failures[i] = body(i); });
  for (const absl::Status& failure : failures) {
    TACTUS_RETURN_IF_ERROR(failure);
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal
