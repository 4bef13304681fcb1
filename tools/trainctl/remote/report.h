// File: report.h
//
// The page of an evaluation that a server made. A server measures confusion,
// accuracy over time and reliability; it sends no trials, so the page has no
// baselines and no worst trials.
//
//   TACTUS_RETURN_IF_ERROR(WriteRemoteReport("page", job));
//
// Thread-safe: free functions without state.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "tactus/v1/operations.pb.h"
#include "tools/common/json.h"

namespace tactus::internal::client {

// As EvaluationToJson() names the figures; those that are missing are left out.
Json ReportToJson(const v1::EvaluationReport& report);

// Writes index.html into `folder`, which is there. `job` is an evaluation that
// succeeded.
absl::Status WriteRemoteReport(const std::string& folder,
                               const v1::Operation& job);

}  // namespace tactus::internal::client
