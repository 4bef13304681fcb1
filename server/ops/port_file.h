// File: port_file.h
//
// Tells other programs where the server listens, once it does.
#pragma once

#include <string>

#include "absl/status/status.h"

namespace tactus::internal::server {

// Writes `port` and a newline to `path` in one step: a reader sees the whole
// file or none. IO if that fails.
absl::Status WritePortFile(const std::string& path, int port);

}  // namespace tactus::internal::server
