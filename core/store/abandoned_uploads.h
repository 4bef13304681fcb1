// File: abandoned_uploads.h
//
// Uploads that nobody finished: which they are, and how one is removed.
//
//   TACTUS_ASSIGN_OR_RETURN(auto uploads, AbandonedUploads(change, now_ms));
//   for (const v1::StoredUpload& upload : uploads) {
//     TACTUS_RETURN_IF_ERROR(
//         RemoveUpload(change, upload, "tactusd", now_ms));
//   }
//
// Thread-safe: free functions without state.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/store/catalog.h"
#include "tactus/v1/storage.pb.h"

namespace tactus::internal {

// True if the upload is not finished, and was made and last written to at least
// limits::kAbandonedUploadMs ago.
bool IsAbandoned(const v1::StoredUpload& upload, int64_t now_ms);

absl::StatusOr<std::vector<v1::StoredUpload>> AbandonedUploads(
    const Transaction& look, int64_t now_ms);

// What follows the slash of its name.
std::string UploadId(const v1::StoredUpload& upload);

// The name of the upload's file in the folder of uploads: its id, and the
// number of the copy behind it if it was copied.
std::string UploadFile(const v1::StoredUpload& upload);

// Removes the record, with an entry of `caller` in the audit log. The number of
// the upload is not given again. The caller removes the file afterwards.
absl::Status RemoveUpload(Transaction& change, const v1::StoredUpload& upload,
                          absl::string_view caller, int64_t now_ms);

// The number of the next upload.
absl::StatusOr<uint64_t> NextUpload(const Transaction& look);

}  // namespace tactus::internal
