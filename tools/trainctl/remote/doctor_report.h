// File: doctor_report.h
//
// What `trainctl doctor` prints: one line for each check, and what to do.
//
//   return PrintChecks(results, /*json=*/false);
//
// Thread-safe: a free function without state.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "core/store/data_check.h"

namespace tactus::internal::client {

// Prints to stdout. OK if all checks are; else an error with the exit code 1
// for warnings or 2 for errors.
absl::Status PrintChecks(const std::vector<CheckResult>& results, bool json);

}  // namespace tactus::internal::client
