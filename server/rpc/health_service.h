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
// Check and Watch both run on our queues: a synchronous Check would wait for
// the threads that calls of reflection may hold. Watch calls are bounded, for
// each peer as well.
//
// Thread-safe. Must outlive the server it is registered with and its queues;
// Serve comes before its queue starts.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_set>

#include "absl/status/status.h"
#include "core/base/limits.h"
#include "grpc/health/v1/health.grpc.pb.h"
#include "server/ops/stream_gate.h"
#include "server/rpc/call_queue.h"

namespace tactus::internal::server {

class HealthCheck;
class HealthWatch;

using HealthServiceBase = grpc::health::v1::Health::AsyncService;

class HealthService final : public HealthServiceBase {
 public:
  using Status = grpc::health::v1::HealthCheckResponse::ServingStatus;

  // Takes calls on `queue`.
  void Serve(CallQueue* queue);

  // Sets the status of `service` and sends it to its watchers; "" is the whole
  // server.
  void SetServing(const std::string& service, bool serving);
  // SERVICE_UNKNOWN if SetServing was never called for it.
  Status status(const std::string& service) const;

  // Watch calls, and those that were refused.
  const StreamGate& watch_gate() const { return watch_gate_; }

 private:
  friend class HealthCheck;
  friend class HealthWatch;

  // Whether a Watch call of `peer` may open.
  absl::Status Admit(const grpc::health::v1::HealthCheckRequest& request,
                     const std::string& peer);

  StreamGate watch_gate_{
      "health watches",
      {.all = limits::kMaxWatches, .per_peer = limits::kMaxWatchesPerPeer}};
  mutable std::mutex mutex_;
  std::map<std::string, Status> statuses_;
  // Which queues there are is fixed once they start; the watches of each
  // belong to its thread.
  std::map<CallQueue*, std::unordered_set<HealthWatch*>> watches_;
};

}  // namespace tactus::internal::server
