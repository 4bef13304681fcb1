// File: default_bundle.h
//
// The model bundle built into tactusd: server/registry/default.tactus, byte
// for byte. Thread-safe; lives as long as the program.
#pragma once

#include "absl/strings/string_view.h"

namespace tactus::server {

absl::string_view DefaultBundle();

}  // namespace tactus::server
