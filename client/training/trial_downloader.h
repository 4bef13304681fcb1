// File: trial_downloader.h
//
// DownloadTrials: receives all trials of a dataset version, one after another.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const DownloadTotals totals,
//       DownloadTrials(client, "datasets/arm/versions/3",
//                      [&](const Trial& trial) { return writer.Append(trial);
//                      },
//                      {}));
//
// If the call breaks, it is repeated: the bytes that came before are read
// again, compared by their CRC32C, and not handed over a second time.
//
// Memory: one message and one trial. Blocks. Several threads may download, each
// with a separate sink.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/training/retry.h"
#include "client/training/training_client.h"
#include "core/data/trial.h"

namespace tactus::internal::client {

struct DownloadTotals {
  uint64_t trials = 0;
  int64_t bytes = 0;
};

struct DownloadOptions {
  RetryOptions retry = {};
  // Called with what has arrived, after each message.
  std::function<void(const DownloadTotals&)> on_progress = {};
};

// `version` is "datasets/D/versions/V": the newest version of a dataset could
// become another one while it is received. INVALID_RESPONSE if the bytes are
// no trial pack, INVALID_TRIAL if a trial is malformed, the error of the sink,
// or the server's.
absl::StatusOr<DownloadTotals> DownloadTrials(
    TrainingClient& client, const std::string& version,
    const std::function<absl::Status(const Trial&)>& sink,
    const DownloadOptions& options);

}  // namespace tactus::internal::client
