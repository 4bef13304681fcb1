// File: health_service.h
//
// HealthService: grpc.health.v1.Health, for probes and load balancers.
//
//   health.SetServing("tactus.v1.ContactService", true);
//   builder.RegisterService(&health);
//   health.Serve(&queue);
//
// gRPC's own would start threads of the callback API, which take part in
// reading sockets and hand what they read to the threads of our queues.
//
// Thread-safe. Must outlive the server it is registered with and its queues;
// Serve comes before its queue starts.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_set>

#include "grpc/health/v1/health.grpc.pb.h"
#include "server/rpc/call_queue.h"

namespace tactus::server {

class HealthWatch;

using HealthServiceBase = grpc::health::v1::Health::WithAsyncMethod_Watch<
    grpc::health::v1::Health::Service>;

class HealthService final : public HealthServiceBase {
 public:
  using Status = grpc::health::v1::HealthCheckResponse::ServingStatus;

  // Takes Watch calls on `queue`.
  void Serve(CallQueue* queue);

  // Tells a service's status, and those who watch; "" is the whole server.
  void SetServing(const std::string& service, bool serving);
  // SERVICE_UNKNOWN if it was never told.
  Status status(const std::string& service) const;

  grpc::Status Check(grpc::ServerContext* context,
                     const grpc::health::v1::HealthCheckRequest* request,
                     grpc::health::v1::HealthCheckResponse* response) override;

 private:
  friend class HealthWatch;

  mutable std::mutex mutex_;
  std::map<std::string, Status> statuses_;
  // Which queues there are is fixed once they start; the watches of each
  // belong to its thread.
  std::map<CallQueue*, std::unordered_set<HealthWatch*>> watches_;
};

}  // namespace tactus::server
