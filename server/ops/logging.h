// File: logging.h
//
// Logging of the process: one line per event on standard error, as text or as a
// JSON object with time, level and message. Nothing is logged per frame.
//
//   TACTUS_RETURN_IF_ERROR(StartLogging("info", LogFormat::kText));
//   spdlog::info("listening on {}", address);
//
// Whatever a message contains, it stays one line of printable ASCII: control
// characters and bytes above 0x7e become \xNN, and text beyond 2,000 bytes is
// cut off. A client can therefore not forge lines through a name that is
// logged. gRPC's own errors become lines of this log too, at most ten a second.
#pragma once

#include <string>

#include "absl/status/status.h"

namespace tactus::internal::server {

enum class LogFormat { kText, kJson };

// `level` is trace, debug, info, warn, error or off; INVALID_CONFIG otherwise.
absl::Status StartLogging(const std::string& level, LogFormat format);

}  // namespace tactus::internal::server
