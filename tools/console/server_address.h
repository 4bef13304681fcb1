// File: server_address.h
//
// ServerAddress: a server that the console shows, and how it is reached.
//
//   TACTUS_RETURN_IF_ERROR(MayTakeToken(server, token));
//   const auto channel =
//       client::MakeTrainingChannel(server.address, server.channel);
//
// Thread-safe: plain data and a free function.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "client/stream/channel.h"

namespace tactus::internal::console {

struct ServerAddress {
  std::string address;
  client::ChannelOptions channel;
};

// OK if a server may be sent a token: it is on the console's host, or its
// connection is encrypted. An empty token may go everywhere.
absl::Status MayTakeToken(const ServerAddress& server,
                          const std::string& token);

}  // namespace tactus::internal::console
