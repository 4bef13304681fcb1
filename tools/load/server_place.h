// File: server_place.h
//
// ServerPlace: where the connections of a load test go. Names are looked up
// once, so that a robot that comes does not wait for that.
//
//   TACTUS_ASSIGN_OR_RETURN(const ServerPlace place,
//                           ServerPlace::Find("127.0.0.1:50051", {}));
//
// Immutable; the TLS context is shared by its connections, on one thread.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "boost/asio/generic/stream_protocol.hpp"
#include "boost/asio/ssl/context.hpp"

namespace tactus::internal::client {

struct ServerPlace {
  using Endpoint = boost::asio::generic::stream_protocol::endpoint;

  // "host:port" or "unix:path". Waits for the name service. UNAVAILABLE for a
  // host without addresses, INVALID_CONFIG for roots without certificates.
  // `tls_roots` as in client/stream/channel.h.
  static absl::StatusOr<ServerPlace> Find(
      const std::string& address, const std::optional<std::string>& tls_roots);

  std::string address = {};
  // To be tried in this order.
  std::vector<Endpoint> endpoints = {};
  // What certificates must name.
  std::string host = {};
  // Null: no TLS.
  std::shared_ptr<boost::asio::ssl::context> tls = nullptr;
};

}  // namespace tactus::internal::client
