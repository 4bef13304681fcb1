// File: robot_id.h
//
// The metadata by which a proxy recognises a robot: x-robot-id. A proxy that
// hashes it sends all streams of one robot to one server
// (deploy/haproxy.cfg). It proves nothing: a client may send any value.
//
//   if (IsRobotId(config.client_id())) {
//     context.AddMetadata(kRobotIdKey, config.client_id());
//   }
//
// Thread-safe: a function without state.
#pragma once

#include <algorithm>

#include "absl/strings/string_view.h"

namespace tactus::internal::client {

inline constexpr char kRobotIdKey[] = "x-robot-id";

// True if `client_id` can be sent as it is: printable ASCII, not empty, and
// without a space at its ends, which HTTP removes. gRPC ends the process if a
// value has other bytes.
inline bool IsRobotId(absl::string_view client_id) {
  return !client_id.empty() && client_id.front() != ' ' &&
         client_id.back() != ' ' &&
         std::all_of(client_id.begin(), client_id.end(),
                     [](char c) { return c >= 0x20 && c <= 0x7e; });
}

}  // namespace tactus::internal::client
