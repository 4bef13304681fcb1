// File: recording_bytes.h
//
// The bytes of a recording on disk: deflated as RFC 1950 says.
//
//   const std::string small = Deflated(bytes);
//   TACTUS_ASSIGN_OR_RETURN(const std::string same,
//                           Inflated(small, bytes.size()));
//
// Thread-safe: free functions without state.
#pragma once

#include <cstddef>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace tactus::internal::server {

std::string Deflated(const std::string& bytes);

// `size`: of the result. DATA_LOST, without more memory than a recording may
// have, if the bytes are not those of so large a recording.
absl::StatusOr<std::string> Inflated(const std::string& deflated, size_t size);

}  // namespace tactus::internal::server
