// File: caller.h
//
// Caller: on whose behalf something is changed. Thread-safe: plain data.
#pragma once

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

}  // namespace tactus::server
