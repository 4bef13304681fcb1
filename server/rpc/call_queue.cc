#include "server/rpc/call_queue.h"

#include <utility>

#include "grpcpp/alarm.h"

namespace tactus::internal::server {
namespace {

// Events of other calls before those that were deferred have their turn.
constexpr int kMostEventsWhileDeferred = 64;

// A task on its way to a queue's thread: an alarm that has expired.
class Task final : public CallEvent {
 public:
  Task(grpc::CompletionQueue* queue, std::function<void()> task)
      : task_(std::move(task)) {
    alarm_.Set(queue, gpr_now(GPR_CLOCK_MONOTONIC), tag());
  }
  void OnEvent(bool) override {
    task_();
    delete this;
  }

 private:
  const std::function<void()> task_;
  grpc::Alarm alarm_;
};

}  // namespace

CallQueue::CallQueue(std::unique_ptr<grpc::ServerCompletionQueue> queue,
                     ArrivalGate* arrivals)
    : queue_(std::move(queue)), arrivals_(arrivals) {}

CallQueue::~CallQueue() {
  if (served_) return;
  queue_->Shutdown();
  Serve();
}

void CallQueue::Start() {
  served_ = true;
  thread_ = std::thread([this] { Serve(); });
}

void CallQueue::Post(std::function<void()> task) {
  // Deletes itself.
  new Task(queue_.get(), std::move(task));
}

void CallQueue::Stop() {
  Post([this] {
    stopping_ = true;
    if (calls_ == 0) queue_->Shutdown();
  });
  thread_.join();
}

void CallQueue::Leave() {
  if (--calls_ == 0 && stopping_) queue_->Shutdown();
}

void CallQueue::Serve() {
  while (HandleNext()) {
    if (!deferred_.empty() && ++events_since_ >= kMostEventsWhileDeferred) {
      HandleDeferred(false);
    }
  }
}

bool CallQueue::HandleNext() {
  void* tag = nullptr;
  bool ok = false;
  if (deferred_.empty()) {
    if (!queue_->Next(&tag, &ok)) return false;
  } else {
    const auto next =
        queue_->AsyncNext(&tag, &ok, gpr_inf_past(GPR_CLOCK_MONOTONIC));
    if (next == grpc::CompletionQueue::SHUTDOWN) return false;
    if (next == grpc::CompletionQueue::TIMEOUT) {
      HandleDeferred(true);
      return true;
    }
  }
  static_cast<CallEvent*>(tag)->OnEvent(ok);
  return true;
}

void CallQueue::HandleDeferred(bool idle) {
  events_since_ = 0;
  due_.swap(deferred_);
  for (CallEvent* event : due_) event->OnEvent(idle);
  due_.clear();
}

}  // namespace tactus::internal::server
