// File: health_probe.h
//
// Asks a server's grpc.health.v1.Health whether it serves.
//
//   auto serving = ProbeHealth(channel, "", std::chrono::seconds(2));
//
// Thread-safe.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "grpcpp/channel.h"

namespace tactus::internal::server {

// True if `service` ("" = the server as a whole) is SERVING. The RPC's own
// error if there is no answer.
absl::StatusOr<bool> ProbeHealth(const std::shared_ptr<grpc::Channel>& channel,
                                 const std::string& service,
                                 std::chrono::milliseconds timeout);

}  // namespace tactus::internal::server
