// File: watchdog.h
//
// Watchdog: bounds how long one thread waits in calls that take no deadline.
//
//   Watchdog watchdog([&] { context.TryCancel(); });
//   watchdog.Start("config", std::chrono::seconds(10));
//   rpc->Write(request);  // returns once it is cancelled
//   watchdog.Stop();
//   TACTUS_RETURN_IF_ERROR(watchdog.status());
//
// Start and Stop only store a time under a lock: the watchdog's thread wakes
// at most once per timeout. Start, Stop and status may be called from any
// thread; the action runs on the watchdog's thread.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "absl/status/status.h"

namespace tactus::internal::client {

class Watchdog {
 public:
  // `on_expiry` runs at most once.
  explicit Watchdog(std::function<void()> on_expiry);
  ~Watchdog();

  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

  // Expects Stop within `timeout`. `what` names the request that the server
  // has to answer until then. A timeout of 0 or less is no limit. Has no
  // effect after the expiry.
  void Start(const char* what, std::chrono::milliseconds timeout);
  void Stop();

  // OK, or NO_RESPONSE after the expiry.
  absl::Status status();

 private:
  using Clock = std::chrono::steady_clock;

  void Run();

  const std::function<void()> on_expiry_;
  std::mutex mutex_;
  std::condition_variable changed_;
  // Unset: no Stop is awaited.
  std::optional<Clock::time_point> deadline_;
  // When the thread wakes next, unless it is notified.
  Clock::time_point wake_ = Clock::time_point::max();
  const char* what_ = "";
  std::chrono::milliseconds timeout_{0};
  bool expired_ = false;
  bool stopping_ = false;
  // The last member, because it uses all others.
  std::thread thread_;
};

}  // namespace tactus::internal::client
