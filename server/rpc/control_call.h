// File: control_call.h
//
// ControlCall: carries one RPC of the services for data, jobs and models
// between gRPC and a handler. A handler is blocking code on a worker thread,
// because it reads and writes files; a queue's thread only starts and ends it,
// so streams do not wait for it.
//
//   new ControlCall(service, queue);  // awaits a call
//
// Two threads use a call: its queue's, on which its events come, and the
// worker, which starts operations and waits for their events. A lock guards
// what both use. The call deletes itself after its last event.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <string>

#include "absl/status/status.h"
#include "grpcpp/generic/async_generic_service.h"
#include "grpcpp/support/byte_buffer.h"
#include "server/records/caller.h"
#include "server/rpc/call_queue.h"
#include "server/rpc/incoming_call.h"

namespace tactus::internal::server {

class ControlService;

// What a handler sees of its call. Used on the worker's thread only.
class ControlStream {
 public:
  // OK and true in `more` if a message came; false after the last one.
  // STREAM_IDLE if the client sends nothing for too long, WORK_CANCELLED if it
  // is gone.
  virtual absl::Status Read(grpc::ByteBuffer* message, bool* more) = 0;
  // Begins to read the next message while the caller works on the last one. The
  // next call must be Read, or the handler returns.
  virtual void StartRead() = 0;
  // Waits until gRPC has taken the message.
  virtual absl::Status Write(const grpc::ByteBuffer& message) = 0;
  // The client is gone, or the server stops.
  virtual bool IsCancelled() const = 0;
  virtual const Caller& caller() const = 0;

 protected:
  ~ControlStream() = default;
};

class ControlCall final : private ControlStream {
 public:
  // Both must outlive it.
  ControlCall(ControlService* service, CallQueue* queue);

  ControlCall(const ControlCall&) = delete;
  ControlCall& operator=(const ControlCall&) = delete;

  // On a worker's thread: runs the handler and sends its status.
  void Work();

  const std::string& method() const { return call_.context().method(); }
  const std::string& peer() const { return call_.peer(); }
  const grpc::ServerContext& context() const { return call_.context(); }

 private:
  using Event = MemberEvent<ControlCall>;

  ~ControlCall() = default;

  absl::Status Read(grpc::ByteBuffer* message, bool* more) override;
  void StartRead() override;
  absl::Status Write(const grpc::ByteBuffer& message) override;
  bool IsCancelled() const override;
  const Caller& caller() const override { return caller_; }

  void OnCalled(bool ok);
  void OnMoved(bool ok);
  void OnGone(bool ok);
  void OnFinished(bool ok);
  void Finish(const absl::Status& status);
  // Waits for the event of the read or write that was started; cancels the call
  // if it does not come in time. True if the operation succeeded.
  bool AwaitMove();
  void EndOperation();

  ControlService* const service_;

  BasicIncomingCall<grpc::GenericServerContext> call_;
  grpc::GenericServerAsyncReaderWriter stream_{call_.context()};
  Event called_{this, &ControlCall::OnCalled};
  Event moved_{this, &ControlCall::OnMoved};
  Event gone_{this, &ControlCall::OnGone};
  Event finish_done_{this, &ControlCall::OnFinished};

  Caller caller_;
  // The service counts it.
  bool admitted_ = false;
  int64_t called_ns_ = 0;
  absl::StatusCode code_ = absl::StatusCode::kOk;
  // Events that are still to come, without that of a read or write for which
  // the handler waits.
  std::atomic<int> in_flight_ = 0;
  // What StartRead reads; true until Read has taken it.
  grpc::ByteBuffer ahead_;
  bool reading_ahead_ = false;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  // A read or write is in flight; its outcome.
  bool moving_ = false;
  bool move_ok_ = false;
  // The handler has returned and left a read in flight.
  bool left_ = false;
  bool timed_out_ = false;
  bool is_gone_ = false;
};

}  // namespace tactus::internal::server
