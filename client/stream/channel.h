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
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "core/base/limits.h"
#include "grpcpp/channel.h"

namespace tactus::internal::client {

struct ChannelOptions {
  // PEM of the authorities that may vouch for the server. If set, every
  // host:port is spoken to in TLS, whatever the text: no connection is made if
  // it holds no certificate. Unix sockets are always plain.
  std::optional<std::string> tls_roots = {};
  // False: this channel has a separate connection, which no other one uses.
  bool share_connection = true;
  // A larger response ends its call. The responses of the training service are
  // larger than those of a stream (client/training/training_client.h).
  int max_receive_bytes = limits::kMaxReceiveBytes;
};

// `address` is "host:port" or "unix:path". Never fails: a wrong address or
// certificate makes the first call fail.
std::shared_ptr<grpc::Channel> MakeChannel(const std::string& address,
                                           const ChannelOptions& options = {});

// The text of a PEM file of certificates. IO if it cannot be read or holds
// none.
absl::StatusOr<std::string> ReadRootCertificates(const std::string& path);

}  // namespace tactus::internal::client
