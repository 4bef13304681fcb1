// File: model_file_error.h
//
// Errors about models in files of other programs: INVALID_MODEL, with the
// file's name first.
//
//   return InvalidModelFile(path, "node 3 is a Conv; ...");
//
// Thread-safe: free functions without state.
#pragma once

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace tactus::internal {

// INVALID_ARGUMENT, reason INVALID_MODEL: "path: message".
absl::Status InvalidModelFile(absl::string_view path,
                              absl::string_view message);

// The same error with the reason INVALID_MODEL if its reason is
// TRIAL_FILE_INVALID, which core/data gives to every file; other errors and OK
// as they are.
absl::Status AsModelFileError(const absl::Status& status);

}  // namespace tactus::internal
