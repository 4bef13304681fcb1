// File: call_queue.h
//
// CallQueue: one of a server's completion queues, and the thread that serves
// it. Whatever happens to a call happens on the thread of its queue, one event
// after another, so calls need no locks.
//
//   CallQueue queue(builder.AddCompletionQueue(), &arrivals);
//   const auto server = builder.BuildAndStart();
//   queue.Start();
//   queue.Post([] { Use(); });
//   server->Shutdown(deadline);
//   queue.Stop();
//
// A call's operations carry one of its CallEvents as their tag. A call counts
// itself in when it is made and out when it is deleted; the queue serves until
// none is left.
//
// Post may come from any thread, at any time before Stop. Start and Stop are
// called once each, by the owner; all else belongs to the queue's thread.
#pragma once

#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "core/base/call_event.h"
#include "grpcpp/completion_queue.h"
#include "server/ops/arrival_gate.h"

namespace tactus::internal::server {

class CallQueue {
 public:
  // `arrivals` must outlive the queue.
  CallQueue(std::unique_ptr<grpc::ServerCompletionQueue> queue,
            ArrivalGate* arrivals);
  // After Stop, or without Start and any call.
  ~CallQueue();

  CallQueue(const CallQueue&) = delete;
  CallQueue& operator=(const CallQueue&) = delete;

  void Start();
  // Runs `task` on the queue's thread.
  void Post(std::function<void()> task);
  // Waits until all calls have ended. Call it after the server was shut down.
  void Stop();

  void Enter() { ++calls_; }
  // The gate at which calls count themselves as arrived.
  ArrivalGate* arrivals() const { return arrivals_; }
  void Leave();
  // Runs `event` with ok = true when the queue is empty, or with ok = false
  // after a short time.
  void Defer(CallEvent* event) { deferred_.push_back(event); }

  grpc::ServerCompletionQueue* queue() { return queue_.get(); }

 private:
  void Serve();
  // False once the queue is shut down and empty.
  bool HandleNext();
  void HandleDeferred(bool idle);

  const std::unique_ptr<grpc::ServerCompletionQueue> queue_;
  ArrivalGate* const arrivals_;
  int calls_ = 0;
  bool stopping_ = false;
  bool served_ = false;
  // What was deferred, the list that it is handed back from, and events since.
  std::vector<CallEvent*> deferred_;
  std::vector<CallEvent*> due_;
  int events_since_ = 0;
  std::thread thread_;
};

}  // namespace tactus::internal::server
