// File: arguments.h
//
// Check of a program's arguments before anything is done with them.
//
//   const absl::Status status = CheckArguments(argc, argv);
//
// Thread-safe: a free function without state.
#pragma once

#include "absl/status/status.h"

namespace tactus::internal {

// INVALID_CONFIG unless every argument is UTF-8: labels, names and notes from
// arguments go into messages, files and JSON, which are UTF-8. Paths of other
// encodings are refused too.
absl::Status CheckArguments(int argc, const char* const* argv);

}  // namespace tactus::internal
