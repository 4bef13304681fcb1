// File: event_loop.h
//
// EventLoop: a client's completion queue, served by whoever calls: one thread
// does all that a load test takes, and looks for answers when it suits it. A
// thread that waits for them would be woken for each, at the server's cost if
// both share a machine.
//
//   EventLoop loop;
//   call->StartCall(started_.tag());            // a CallEvent, on loop.queue()
//   loop.HandleUntil([&] { return started; }, timeout);
//   loop.HandleReady(connections);
//
// All operations must be over before it is deleted. Not thread-safe.
#pragma once

#include <chrono>

#include "core/base/call_event.h"
#include "grpcpp/completion_queue.h"

namespace tactus::internal::client {

class EventLoop {
 public:
  EventLoop() = default;
  ~EventLoop() {
    queue_.Shutdown();
    void* tag = nullptr;
    bool ok = false;
    while (queue_.Next(&tag, &ok)) static_cast<CallEvent*>(tag)->OnEvent(ok);
  }

  EventLoop(const EventLoop&) = delete;
  EventLoop& operator=(const EventLoop&) = delete;

  grpc::CompletionQueue* queue() { return &queue_; }

  // Handles what has come over `connections`. gRPC reads one connection a
  // look, and a look may bring no event.
  void HandleReady(int connections) {
    for (int looks = 0; looks <= connections;) {
      if (!HandleOne(gpr_inf_past(GPR_CLOCK_MONOTONIC))) ++looks;
    }
  }
  // Handles events until `done()`; false if that takes longer than `timeout`.
  template <typename Done>
  bool HandleUntil(Done done, std::chrono::milliseconds timeout) {
    const auto deadline = std::chrono::system_clock::now() + timeout;
    while (!done()) {
      if (!HandleOne(deadline)) return done();
    }
    return true;
  }

 private:
  // False if no event came.
  template <typename Deadline>
  bool HandleOne(const Deadline& deadline) {
    void* tag = nullptr;
    bool ok = false;
    if (queue_.AsyncNext(&tag, &ok, deadline) !=
        grpc::CompletionQueue::GOT_EVENT) {
      return false;
    }
    static_cast<CallEvent*>(tag)->OnEvent(ok);
    return true;
  }

  grpc::CompletionQueue queue_;
};

}  // namespace tactus::internal::client
