// File: time_limit.h
//
// TimeLimit: ends a test whose bug is that a call never returns. Without it
// such a test hangs until ctest kills the whole program.
//
//   TimeLimit limit("Open() waits for a silent server", [&] { peer.Stop(); });
//   ContactStream::Open(channel, config, ...);  // returns, or the test fails
//
// After the limit the test fails with the text, and `release` ends the wait: it
// is called on another thread and must make the call return. The limit is far
// above what a loaded machine needs. The destructor ends the watch. Test-only.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "gtest/gtest.h"

namespace tactus::internal::testing {

// How long a call that must return may take.
inline constexpr std::chrono::seconds kLongestCall(60);

class TimeLimit {
 public:
  TimeLimit(std::string what, std::function<void()> release)
      : what_(std::move(what)),
        release_(std::move(release)),
        thread_([this] { Watch(); }) {}
  ~TimeLimit() {
    {
      const std::lock_guard lock(mutex_);
      ended_ = true;
    }
    changed_.notify_one();
    thread_.join();
  }

  TimeLimit(const TimeLimit&) = delete;
  TimeLimit& operator=(const TimeLimit&) = delete;

 private:
  void Watch() {
    std::unique_lock lock(mutex_);
    if (changed_.wait_for(lock, kLongestCall, [this] { return ended_; })) {
      return;
    }
    ADD_FAILURE() << what_ << ", for more than " << kLongestCall.count()
                  << " s";
    release_();
  }

  const std::string what_;
  const std::function<void()> release_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool ended_ = false;
  // Last, so that it starts when everything else is there.
  std::thread thread_;
};

}  // namespace tactus::internal::testing
