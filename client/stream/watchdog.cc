#include "client/stream/watchdog.h"

#include <algorithm>
#include <utility>

#include "core/base/errors.h"

namespace tactus::internal::client {
namespace {

// Longer timeouts are cut to this, so that no time point overflows.
constexpr std::chrono::hours kLongest(24 * 365);

}  // namespace

Watchdog::Watchdog(std::function<void()> on_expiry)
    : on_expiry_(std::move(on_expiry)), thread_([this] { Run(); }) {}

Watchdog::~Watchdog() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void Watchdog::Start(const char* what, std::chrono::milliseconds timeout) {
  if (timeout.count() <= 0) return;
  const std::lock_guard lock(mutex_);
  if (expired_) return;
  what_ = what;
  timeout_ = std::min<std::chrono::milliseconds>(timeout, kLongest);
  deadline_ = Clock::now() + timeout_;
  if (*deadline_ < wake_) changed_.notify_one();
}

void Watchdog::Stop() {
  const std::lock_guard lock(mutex_);
  deadline_.reset();
}

absl::Status Watchdog::status() {
  const std::lock_guard lock(mutex_);
  return expired_ ? NoResponse(what_, timeout_.count()) : absl::OkStatus();
}

void Watchdog::Run() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    wake_ = deadline_.value_or(Clock::time_point::max());
    if (!deadline_) {
      changed_.wait(lock);
    } else if (Clock::now() < wake_) {
      changed_.wait_until(lock, wake_);
    } else {
      expired_ = true;
      lock.unlock();
      on_expiry_();
      return;
    }
  }
}

}  // namespace tactus::internal::client
