// File: peer.h
//
// Names the peer of a call, for limits that hold per peer.
//
//   const absl::Status status = gate.Enter(PeerOf(context.peer()));
//
// A free function without state; thread-safe.
#pragma once

#include <string>

#include "absl/strings/string_view.h"

namespace tactus::server {

// The peer of `address`, which is what grpc::ServerContext::peer() returns:
//
//   ipv4:192.0.2.7:50123            192.0.2.7
//   ipv6:%5B2001:db8::1%5D:50123    2001:db8:0:0::/64, because one host may
//                                   use all addresses of its network
//   unix:/run/client                unix, one peer for all unix sockets
//
// Anything else is returned as it is.
std::string PeerOf(absl::string_view address);

}  // namespace tactus::server
