// File: control_service.h
//
// ControlService: the RPCs for data, jobs and models, by their names. Every
// method that no other service registered comes here.
//
//   ControlService control(authorize, &metrics.rpcs);
//   control.Add("/tactus.v1.ModelService/ListAliases", Role::kRobot, handler);
//   builder.RegisterAsyncGenericService(control.generic());
//   control.Serve(&queue);
//
// Handlers run on at most limits::kMaxControlCalls threads. Thread-safe after
// the last Add. Must outlive the gRPC server and its queues.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/access/role.h"
#include "core/base/limits.h"
#include "grpcpp/generic/async_generic_service.h"
#include "server/metrics/rpc_metrics.h"
#include "server/ops/stream_gate.h"
#include "server/rpc/control_call.h"

namespace tactus::internal::server {

class ControlService {
 public:
  using Handler = std::function<absl::Status(ControlStream&)>;
  // Names the caller of a call, or refuses it. `role`: what the method needs.
  using Authorize = std::function<absl::StatusOr<Caller>(
      const grpc::ServerContext& context, const std::string& method,
      Role role)>;

  // `rpcs` must outlive it.
  ControlService(Authorize authorize, RpcMetrics* rpcs)
      : authorize_(std::move(authorize)), rpcs_(rpcs) {}
  // After StopWorkers.
  ~ControlService();

  // `method`: "/tactus.v1.Service/Method".
  void Add(const std::string& method, Role role, Handler handler);

  // Takes calls on `queue`. Call it before the queue starts.
  void Serve(CallQueue* queue);
  // Refuses new calls; handlers see that they are cancelled.
  void StartDraining() { draining_ = true; }
  bool draining() const { return draining_; }
  // Waits for the handlers that run. Call it when no call can come any more.
  void StopWorkers();

  grpc::AsyncGenericService* generic() { return &generic_; }
  RpcMetrics* rpcs() { return rpcs_; }
  const StreamGate& gate() const { return gate_; }

  // For ControlCall. UNIMPLEMENTED if there is no such method; why the caller
  // is refused; STREAM_LIMIT.
  absl::Status Admit(ControlCall* call, Caller* caller);
  void Run(ControlCall* call);
  absl::Status Handle(const std::string& method, ControlStream& stream) const;
  void Release(ControlCall* call);

 private:
  struct Method {
    Role role = Role::kAdmin;
    Handler handler;
  };

  void ServeCalls();

  const Authorize authorize_;
  RpcMetrics* const rpcs_;
  grpc::AsyncGenericService generic_;
  std::map<std::string, Method> methods_;
  StreamGate gate_{"calls of data, jobs and models",
                   {.all = limits::kMaxControlCalls,
                    .per_peer = limits::kMaxControlCallsPerPeer}};
  std::atomic<bool> draining_ = false;

  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<ControlCall*> waiting_;
  std::vector<std::thread> workers_;
  int idle_ = 0;
  bool stopping_ = false;
};

}  // namespace tactus::internal::server
