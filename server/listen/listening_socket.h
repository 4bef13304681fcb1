// File: listening_socket.h
//
// ListeningSocket: a socket that clients can connect to.
//
//   TACTUS_ASSIGN_OR_RETURN(auto sockets, ListenOn("127.0.0.1:50051"));
//   sockets.front().bound.port();
//
// Owns its descriptor, and the file of a unix socket, which it removes. Not
// thread-safe.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "server/listen/file_descriptor.h"
#include "server/listen/socket_address.h"

namespace tactus::internal::server {

struct ListeningSocket {
  ListeningSocket() = default;
  ListeningSocket(ListeningSocket&&) = default;
  ListeningSocket& operator=(ListeningSocket&&) = default;
  ~ListeningSocket();

  // As the user wrote it.
  std::string address;
  SocketAddress bound;
  // Non-blocking.
  FileDescriptor fd;
};

// Opens the sockets of `address`, "host:port" or "unix:path": one for each
// address that the host resolves to, all on the same port (port 0 takes a free
// one). "0.0.0.0" means IPv4; "[::]" means IPv6 and IPv4.
//
// INVALID_CONFIG if the text is no address; IO, with the reason, if nothing
// can listen there. A unix socket left by a server that is gone is replaced,
// one that is still served is not.
absl::StatusOr<std::vector<ListeningSocket>> ListenOn(
    const std::string& address);

}  // namespace tactus::internal::server
