// File: file_bytes.h
//
// Whole small files into memory, for the importers.
//
//   TACTUS_ASSIGN_OR_RETURN(std::string text, ReadFileBytes(path, 1 << 20));
//
// Thread-safe: a free function without state.
#pragma once

#include <cstddef>
#include <string>

#include "absl/status/statusor.h"

namespace tactus::internal {

// IO if the file cannot be read; TRIAL_FILE_INVALID if it has more than
// `limit` bytes.
absl::StatusOr<std::string> ReadFileBytes(const std::string& path,
                                          size_t limit);

}  // namespace tactus::internal
