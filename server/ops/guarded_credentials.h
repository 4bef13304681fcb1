// File: guarded_credentials.h
//
// Puts an ArrivalGate in front of a listener. gRPC asks the gate on the thread
// that parses a call's headers, before it queues the call; a call that the gate
// refuses ends there with RESOURCE_EXHAUSTED and its memory is free again; a
// call of an unknown service ends there with UNIMPLEMENTED.
//
//   CallRefuser refuser(&gate);
//   const Guards guards = {&gate, &refuser, false};
//   builder.AddListeningPort(
//       address, Guard(grpc::InsecureServerCredentials(), guards), &port);
//
// gRPC offers this hook as the processor of authentication metadata. The
// refuser is a thread that ends some of the refused calls: gRPC then moves the
// flooded connection to a separate thread, and the thread that read it serves
// its other streams again.
//
// What `guards` points to must outlive the server. Thread-safe.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "grpc/grpc_security.h"
#include "grpcpp/security/server_credentials.h"
#include "server/ops/arrival_gate.h"

namespace tactus::internal::server {

// Ends refused calls on its own thread, at most a few at a time, and logs once
// per second how many calls were refused. When it is idle, it gives memory that
// a flood has left free back to the system.
class CallRefuser {
 public:
  explicit CallRefuser(const ArrivalGate* gate);
  // Ends what it was given.
  ~CallRefuser();

  // Ends a call through gRPC's callback, here or on the refuser's thread.
  void Refuse(grpc_process_auth_metadata_done_cb done, void* call);

 private:
  void Run();

  const ArrivalGate* const gate_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::vector<std::pair<grpc_process_auth_metadata_done_cb, void*>> calls_;
  bool stopping_ = false;
  std::thread thread_;
};

struct Guards {
  ArrivalGate* gate = nullptr;
  CallRefuser* refuser = nullptr;
  // Whether the server has the service grpc.reflection.
  bool reflection = false;
};

// The same credentials behind `guards`.
std::shared_ptr<grpc::ServerCredentials> Guard(
    std::shared_ptr<grpc::ServerCredentials> credentials, const Guards& guards);

}  // namespace tactus::internal::server
