// File: socket_address.h
//
// SocketAddress: where one end of a connection is, as the kernel names it.
//
//   const SocketAddress peer = SocketAddress::OfPeer(fd);
//   spdlog::info("a connection from {}", peer.HostText());
//
// Plain data; thread-safe as such.
#pragma once

#include <sys/socket.h>

#include <string>

namespace tactus::internal::server {

struct SocketAddress {
  sockaddr_storage storage = {};
  socklen_t length = 0;

  static SocketAddress OfPeer(int fd);
  static SocketAddress OfSocket(int fd);

  const sockaddr* get() const {
    return reinterpret_cast<const sockaddr*>(&storage);
  }
  sockaddr* get() { return reinterpret_cast<sockaddr*>(&storage); }
  int family() const { return storage.ss_family; }
  bool is_unix() const { return family() == AF_UNIX; }
  // 0 for unix sockets.
  int port() const;
  void set_port(int port);
  // Where a client on this machine connects to reach a socket that is bound
  // here: loopback in place of a wildcard.
  SocketAddress Reachable() const;
  // "127.0.0.1", "2001:db8::1" or "a unix socket".
  std::string HostText() const;

  // The same bytes: family, host, port or path.
  bool operator==(const SocketAddress& other) const;
};

}  // namespace tactus::internal::server
