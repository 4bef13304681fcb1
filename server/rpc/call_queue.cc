#include "server/rpc/call_queue.h"

#include <utility>

#include "grpcpp/alarm.h"

namespace tactus::server {
namespace {

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

CallQueue::CallQueue(std::unique_ptr<grpc::ServerCompletionQueue> queue)
    : queue_(std::move(queue)) {}

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
  void* tag = nullptr;
  bool ok = false;
  while (queue_->Next(&tag, &ok)) static_cast<CallEvent*>(tag)->OnEvent(ok);
}

}  // namespace tactus::server
