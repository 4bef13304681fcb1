// File: grpc_connection.h
//
// GrpcConnection: one connection to a server, over which calls go. gRPC's own
// client takes more processor time for a message than the server that is to be
// measured; this one takes a third.
//
//   auto connection = std::make_shared<GrpcConnection>(&loop, place);
//   connection->Start(&call);   // as soon as it is connected
//
// Connects at once, and ends all calls with UNAVAILABLE when it cannot, or when
// the connection is lost; it does not connect again. `loop` must outlive it,
// and it its calls. Not thread-safe.
#pragma once

#include <memory>

#include "tools/load/connection_loop.h"
#include "tools/load/grpc_call.h"
#include "tools/load/server_place.h"

namespace tactus::internal::client {

class GrpcConnection {
 public:
  GrpcConnection(ConnectionLoop* loop, const ServerPlace& place);
  // Closes it.
  ~GrpcConnection();
  GrpcConnection(const GrpcConnection&) = delete;
  GrpcConnection& operator=(const GrpcConnection&) = delete;

  void Start(GrpcCall* call);
  // False once it is lost, or the server wants no more calls over it.
  bool takes_calls() const;

 private:
  class Link;
  // Lives until the socket's last operation is over.
  std::shared_ptr<Link> link_;
};

}  // namespace tactus::internal::client
