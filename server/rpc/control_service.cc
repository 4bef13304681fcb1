#include "server/rpc/control_service.h"

#include <utility>

#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"

namespace tactus::internal::server {

ControlService::~ControlService() { StopWorkers(); }

void ControlService::Add(const std::string& method, Role role,
                         Handler handler) {
  methods_[method] = {role, std::move(handler)};
}

void ControlService::Serve(CallQueue* queue) {
  // Deletes itself.
  new ControlCall(this, queue);
}

absl::Status ControlService::Admit(ControlCall* call, Caller* caller) {
  const auto method = methods_.find(call->method());
  if (method == methods_.end()) {
    return absl::UnimplementedError(
        absl::StrCat("the server has no method ", Quoted(call->method())));
  }
  if (draining_) return Draining();
  TACTUS_ASSIGN_OR_RETURN(*caller, authorize_(call->context(), call->method(),
                                              method->second.role));
  return gate_.Enter(call->peer());
}

void ControlService::Run(ControlCall* call) {
  const std::lock_guard lock(mutex_);
  waiting_.push_back(call);
  // The gate bounds the calls, and with them the threads.
  if (idle_ < static_cast<int>(waiting_.size())) {
    workers_.emplace_back([this] { ServeCalls(); });
  } else {
    wake_.notify_one();
  }
}

void ControlService::ServeCalls() {
  std::unique_lock lock(mutex_);
  while (true) {
    ++idle_;
    wake_.wait(lock, [this] { return stopping_ || !waiting_.empty(); });
    --idle_;
    if (waiting_.empty()) return;
    ControlCall* call = waiting_.front();
    waiting_.pop_front();
    lock.unlock();
    call->Work();
    lock.lock();
  }
}

absl::Status ControlService::Handle(const std::string& method,
                                    ControlStream& stream) const {
  return methods_.at(method).handler(stream);
}

void ControlService::Release(ControlCall* call) {
  gate_.Leave(call->peer(), 0);
}

void ControlService::StopWorkers() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    wake_.notify_all();
  }
  for (std::thread& worker : workers_) worker.join();
  workers_.clear();
}

}  // namespace tactus::internal::server
