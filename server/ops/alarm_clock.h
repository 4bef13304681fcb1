// File: alarm_clock.h
//
// AlarmClock: does something at a time, unless it is destroyed before.
//
//   const AlarmClock alarm(deadline, [&] { connections.CutOff(); });
//   WaitForTheRest();  // the alarm is off when `alarm` goes out of scope
//
// `action` runs on the clock's thread, at most once; the destructor waits for
// it. The object belongs to one thread.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

namespace tactus::internal::server {

class AlarmClock {
 public:
  AlarmClock(std::chrono::system_clock::time_point time,
             std::function<void()> action)
      : thread_([this, time, action = std::move(action)] {
          std::unique_lock lock(mutex_);
          if (!off_.wait_until(lock, time, [this] { return is_off_; })) {
            action();
          }
        }) {}
  ~AlarmClock() {
    {
      const std::lock_guard lock(mutex_);
      is_off_ = true;
    }
    off_.notify_all();
    thread_.join();
  }

  AlarmClock(const AlarmClock&) = delete;
  AlarmClock& operator=(const AlarmClock&) = delete;

 private:
  std::mutex mutex_;
  std::condition_variable off_;
  bool is_off_ = false;
  // Last, so that it starts when everything else is there.
  std::thread thread_;
};

}  // namespace tactus::internal::server
