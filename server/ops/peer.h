// File: peer.h
//
// Names the peer of a call or of a connection, for limits that hold per peer.
//
//   const absl::Status status = gate.Enter(PeerOf(context.peer()));
//
// Free functions without state; thread-safe.
#pragma once

#include <string>

#include "absl/strings/string_view.h"

namespace tactus::internal::server {

// The peer at the IP address `host`:
//
//   192.0.2.7           192.0.2.7
//   ::ffff:192.0.2.7    192.0.2.7, the same address in IPv6 form
//   2001:db8::1         2001:db8:0:0::/64, because one host may use all
//                       addresses of its network
//
// Anything else is returned as it is.
std::string PeerOfHost(absl::string_view host);

// The peer of `address`, which is what grpc::ServerContext::peer() returns:
//
//   ipv4:192.0.2.7:50123            192.0.2.7
//   ipv6:%5B2001:db8::1%5D:50123    2001:db8:0:0::/64
//   unix:/run/client                unix, one peer for all unix sockets
//
// Anything else is returned as it is.
std::string PeerOf(absl::string_view address);

// True if `address`, as above, is on the server's own host: a loopback address
// (127.0.0.0/8, ::1, and the former in IPv6 form), a unix socket, or this
// process. False for every text that is none of these.
bool IsOnThisHost(absl::string_view address);

}  // namespace tactus::internal::server
