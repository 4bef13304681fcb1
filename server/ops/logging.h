// File: logging.h
//
// Logging of the process: one line an event on standard error. Nothing is
// logged per frame.
#pragma once

#include <string>

#include "absl/status/status.h"

namespace tactus::server {

// `level` is trace, debug, info, warn, error or off; INVALID_CONFIG otherwise.
absl::Status StartLogging(const std::string& level);

}  // namespace tactus::server
