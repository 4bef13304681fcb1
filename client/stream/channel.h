// File: channel.h
//
// Channels to a server, with the keep-alive it expects.
//
//   const auto channel = MakeChannel("127.0.0.1:50051");
//
//   TACTUS_ASSIGN_OR_RETURN(const std::string roots,
//                           ReadRootCertificates("ca.crt"));
//   const auto safe = MakeChannel("arm.lab:50051", {.tls_roots = roots});
//
// Thread-safe.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "grpcpp/channel.h"

namespace tactus::client {

struct ChannelOptions {
  // PEM of the authorities that may vouch for the server; empty: no TLS. Unix
  // sockets are always plain.
  std::string tls_roots;
  // False: a connection of its own, shared with no other channel.
  bool share_connection = true;
};

// `address` is "host:port" or "unix:path". Never fails: what is wrong shows
// with the first call.
std::shared_ptr<grpc::Channel> MakeChannel(const std::string& address,
                                           const ChannelOptions& options = {});

// The text of a PEM file; empty for an empty path. IO if it cannot be read.
absl::StatusOr<std::string> ReadRootCertificates(const std::string& path);

}  // namespace tactus::client
