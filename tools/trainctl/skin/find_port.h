// File: find_port.h
//
// Finds the serial line of a skin, as FindPort does, and says which it is.
//
//   TACTUS_RETURN_IF_ERROR(FindPortAloud(flags.source));
//
// Not thread-safe.
#pragma once

#include "absl/status/status.h"
#include "tools/common/skin_source.h"

namespace tactus::internal::client {

// Prints on standard error what it found.
absl::Status FindPortAloud(SkinSourceOptions& options);

}  // namespace tactus::internal::client
