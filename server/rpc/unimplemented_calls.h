// File: unimplemented_calls.h
//
// UnimplementedCalls: answers every method that no service has with
// UNIMPLEMENTED, our reason and the method's name.
//
//   builder.RegisterAsyncGenericService(calls.service());
//   calls.Serve(&queue);
//
// Must outlive its queues. Serve comes before its queue starts.
#pragma once

#include "grpcpp/generic/async_generic_service.h"
#include "server/rpc/call_queue.h"

namespace tactus::server {

class UnimplementedCalls {
 public:
  grpc::AsyncGenericService* service() { return &service_; }
  void Serve(CallQueue* queue);

 private:
  grpc::AsyncGenericService service_;
};

}  // namespace tactus::server
