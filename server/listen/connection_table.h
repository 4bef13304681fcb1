// File: connection_table.h
//
// ConnectionTable: how many connections there are, in all and from each peer,
// and whether another one may come.
//
//   ConnectionTable table({.connections = 4096, .per_peer = 2048});
//   const std::string peer = PeerOfHost(address.HostText());
//   if (table.Admit(fd, peer) != Verdict::kAdmitted) close(fd);
//
// gRPC does not report when it closes a connection. The table therefore
// remembers each descriptor with the inode of its socket; a connection is over
// when its descriptor no longer refers to that inode. The table looks only when
// a limit is reached, and at most every 20 ms, because it asks the kernel about
// each connection.
//
// Nor does gRPC 1.51 close a connection whose peer stops reading: its keepalive
// waits until the bytes before the ping are out. On TCP the kernel ends such a
// connection when the peer's machine is gone; else ShutDownUnread does.
//
// Not thread-safe.
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>

namespace tactus::internal::server {

enum class Verdict { kAdmitted, kTooMany, kTooManyOfPeer };

class ConnectionTable {
 public:
  struct Limits {
    int connections = 0;
    int per_peer = 0;
  };

  explicit ConnectionTable(const Limits& limits) : limits_(limits) {}

  // Counts the connection on `fd`, an open socket, or returns which limit
  // is reached. An empty `peer` has no limit per peer.
  Verdict Admit(int fd, const std::string& peer);

  // Ends each connection whose peer has taken nothing of what waits in the
  // kernel since `timeout_ns` or longer, as seen by the calls of this function.
  // Returns how many it ended.
  int ShutDownUnread(int64_t now_ns, int64_t timeout_ns);
  // Ends every connection that is still open, for whoever reads or writes it.
  void ShutDownAll() const;

  const Limits& limits() const { return limits_; }
  // Includes connections that have ended since the table last looked.
  int size() const { return static_cast<int>(connections_.size()); }

 private:
  struct Connection {
    uint64_t inode = 0;
    std::string peer;
    // Bytes that waited for the peer at the last look, and since when as many.
    int unread_bytes = 0;
    int64_t unread_since_ns = 0;
  };

  Verdict Check(const std::string& peer) const;
  void Remove(int fd);
  void RemoveEnded();

  const Limits limits_;
  std::unordered_map<int, Connection> connections_;
  std::unordered_map<std::string, int> per_peer_;
  int64_t last_look_ns_ = 0;
};

}  // namespace tactus::internal::server
