// File: event_thread.h
//
// EventThread: a client's completion queue and the thread that serves it. Half
// the cost of gRPC's callbacks, whose threads wake one another.
//
//   EventThread events;
//   call->StartCall(started_.tag());   // a CallEvent, on events.queue()
//
// Events are handled on its thread, one after another. All operations must be
// over before it is deleted. queue() is thread-safe.
#pragma once

#include <thread>

#include "core/base/call_event.h"
#include "grpcpp/completion_queue.h"

namespace tactus::client {

class EventThread {
 public:
  EventThread() : thread_([this] { Serve(); }) {}
  ~EventThread() {
    queue_.Shutdown();
    thread_.join();
  }

  EventThread(const EventThread&) = delete;
  EventThread& operator=(const EventThread&) = delete;

  grpc::CompletionQueue* queue() { return &queue_; }

 private:
  void Serve() {
    void* tag = nullptr;
    bool ok = false;
    while (queue_.Next(&tag, &ok)) static_cast<CallEvent*>(tag)->OnEvent(ok);
  }

  grpc::CompletionQueue queue_;
  std::thread thread_;
};

}  // namespace tactus::client
