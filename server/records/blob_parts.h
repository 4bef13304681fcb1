// File: blob_parts.h
//
// Reads a blob in parts, for callers that may take their time: a blob of 64 MiB
// then takes 1 MiB of memory.
//
//   TACTUS_RETURN_IF_ERROR(ReadBlobParts(data, sha256, limit, send));
//
// The SHA-256 is compared before the first part is handed out. Blobs never
// change, so the parts are then right as well.
//
// Thread-safe: a free function without state.
#pragma once

#include <cstdint>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "core/store/data_directory.h"

namespace tactus::internal::server {

// Runs `take` on each part, in order; ends with its first error. DATA_LOST if
// the blob does not exist, is larger than `limit`, or does not have this
// SHA-256.
absl::Status ReadBlobParts(
    const DataDirectory& data, absl::string_view sha256, int64_t limit,
    absl::FunctionRef<absl::Status(absl::string_view)> take);

}  // namespace tactus::internal::server
