// File: caller.h
//
// Caller: on whose behalf something is changed. Thread-safe: plain data.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

namespace tactus::server {

struct Caller {
  // A token's name, a certificate's subject, or the peer.
  std::string name;
  // Address of the connection.
  std::string peer;
};

// Milliseconds since 1970 (UTC). Given to what stores times, so that tests may
// set them.
using NowMs = std::function<int64_t()>;

// The system's clock as a NowMs.
inline int64_t SystemNowMs() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace tactus::server
