// File: refusal.h
//
// Reactors that answer an RPC with an error and nothing else. They delete
// themselves when gRPC is done with them.
#pragma once

#include "absl/status/status.h"
#include "grpcpp/generic/async_generic_service.h"
#include "grpcpp/support/byte_buffer.h"
#include "grpcpp/support/server_callback.h"

namespace tactus::server {

using BytesReactor =
    grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>;

BytesReactor* RefuseStream(const absl::Status& status);

// Answers every method that no other service has: UNIMPLEMENTED with our
// reason and the method's name.
class UnimplementedService : public grpc::CallbackGenericService {
 public:
  grpc::ServerGenericBidiReactor* CreateReactor(
      grpc::GenericCallbackServerContext* context) override;
};

}  // namespace tactus::server
