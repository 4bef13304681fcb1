// File: quotas.h
//
// Quotas: what one client may have. A client is a caller's name: a token, a
// certificate or, without credentials, a peer.
//
//   return data->catalog().Change([&](Transaction& change) -> absl::Status {
//     TACTUS_RETURN_IF_ERROR(CheckStoredBytes(change, quotas, client, more));
//     return PutRecord(change, Table::kUploads, key, upload);
//   });
//
// The checks read what is stored, in the transaction that adds to it, so two
// writers cannot pass together, and what is deleted no longer counts.
//
// Errors: QUOTA_EXCEEDED. Thread-safe: free functions without state.
#pragma once

#include <cstdint>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/base/limits_training.h"
#include "core/store/catalog.h"

namespace tactus::internal::server {

// 0 means no limit.
struct Quotas {
  int64_t stored_bytes = 0;
  int64_t datasets = 0;
  int64_t queued_jobs = 0;
  int64_t model_bytes = 0;
  int64_t open_uploads = limits::kMaxOpenUploads;
};

// Bytes of the client's unfinished uploads, and of the trials that it added to
// datasets. A trial that it adds to two datasets counts twice.
absl::StatusOr<int64_t> StoredBytes(const Transaction& look,
                                    absl::string_view client);

// Refuses `more` bytes of the client.
absl::Status CheckStoredBytes(const Transaction& look, const Quotas& quotas,
                              absl::string_view client, int64_t more);
// Refuses one more dataset.
absl::Status CheckDatasets(const Transaction& look, const Quotas& quotas,
                           absl::string_view client);
// Refuses one more upload that is not finished.
absl::Status CheckUploads(const Transaction& look, const Quotas& quotas,
                          absl::string_view client);
// Refuses one more model version of `more` bytes. The server holds all versions
// in memory.
absl::Status CheckModelBytes(const Transaction& look, const Quotas& quotas,
                             absl::string_view client, int64_t more);
// Refuses one more job that waits.
absl::Status CheckQueuedJobs(const Transaction& look, const Quotas& quotas,
                             absl::string_view client);

}  // namespace tactus::internal::server
