// File: caller.h
//
// Caller: on whose behalf something is changed.
//
//   TACTUS_RETURN_IF_ERROR(
//       CheckOwner(caller, upload.name(), upload.requester()));
//
// Thread-safe: plain data and free functions.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "core/access/role.h"
#include "core/base/errors.h"

namespace tactus::internal::server {

struct Caller {
  // A token's name, a certificate's subject, or the peer.
  std::string name;
  // Address of the connection.
  std::string peer;
  Role role = Role::kRobot;
};

// PERMISSION_DENIED unless the caller is `owner`, or an admin. `name`: the
// thing that the owner made.
inline absl::Status CheckOwner(const Caller& caller, absl::string_view name,
                               absl::string_view owner) {
  if (caller.name == owner || caller.role == Role::kAdmin) {
    return absl::OkStatus();
  }
  return NotOwner(name, owner);
}

// Milliseconds since 1970 (UTC). Given to what stores times, so that tests may
// set them.
using NowMs = std::function<int64_t()>;

// The system's clock as a NowMs.
inline int64_t SystemNowMs() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace tactus::internal::server
