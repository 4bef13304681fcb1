// File: trial_info.h
//
// What a dataset knows of a trial without reading it, and copies of trials
// under another id.
//
//   v1::TrialInfo info = InfoOf(record, trial, sha256, bytes.size());
//   TACTUS_RETURN_IF_ERROR(StoreRenamed(blobs, batch, "touch-2", info));
//
// Thread-safe: free functions without state.
#pragma once

#include <cstddef>
#include <string>

#include "absl/status/status.h"
#include "core/data/trial.h"
#include "core/store/blob_store.h"
#include "tactus/v1/training.pb.h"
#include "tactus/v1/trial.pb.h"

namespace tactus::internal::server {

// `trial`: that of the record, whose bytes have this SHA-256 and size.
v1::TrialInfo InfoOf(const v1::TrialRecord& record, const Trial& trial,
                     const std::string& sha256, size_t bytes);

// Adds a copy of the trial's blob with another id to `batch`, and names it in
// `trial`. INVALID_TRIAL if there is no room for the id; errors of storage.
absl::Status StoreRenamed(BlobStore& blobs, BlobStore::Batch& batch,
                          const std::string& id, v1::TrialInfo& trial);

}  // namespace tactus::internal::server
