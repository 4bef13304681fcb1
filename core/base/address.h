// File: address.h
//
// Addresses of servers as users write them: "host:port" or "unix:path". The
// server and its clients decide here, and nowhere else, which of the two an
// address is. The answer decides whether TLS is used: a unix socket has none.
//
//   if (IsUnixAddress(address)) path = UnixPath(address);
//   TACTUS_ASSIGN_OR_RETURN(const HostPort at, ParseHostPort("[::1]:50051"));
//
// Plain data and free functions; thread-safe.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace tactus::internal {

struct HostPort {
  // Without the brackets of an IPv6 address.
  std::string host;
  // 0 to 65535.
  int port = 0;
};

// True if `address` begins with "unix:". A host named "unixbox" is a host.
bool IsUnixAddress(absl::string_view address);

// The path of a unix address: "unix:path" or "unix:///absolute/path".
std::string UnixPath(absl::string_view address);

// True if a connection to `address` does not leave this host: a unix socket,
// "localhost" or a loopback address.
bool StaysOnThisHost(absl::string_view address);

// INVALID_CONFIG unless `address` is host:port, with a host and a number.
// Colons are allowed in a host only inside brackets.
absl::StatusOr<HostPort> ParseHostPort(absl::string_view address);

}  // namespace tactus::internal
