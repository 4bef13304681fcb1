// File: log_limiter.h
//
// LogLimiter: bounds how many lines of one kind are logged, so that a client
// that causes an event often does not fill the disk.
//
//   LogLimiter limiter({.lines_per_second = 10, .burst = 100});
//   if (const auto left_out = limiter.Admit(MonotonicNs())) {
//     spdlog::warn("refused a connection{}", LeftOut(*left_out));
//   }
//
// Thread-safe, lock-free.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

#include "absl/strings/str_cat.h"

namespace tactus::internal::server {

class LogLimiter {
 public:
  struct Options {
    int lines_per_second = 10;
    // Lines after a silence that pass at once.
    int burst = 100;
  };

  explicit LogLimiter(const Options& options)
      : interval_ns_(int64_t{1'000'000'000} / options.lines_per_second),
        burst_ns_(interval_ns_ * options.burst) {}

  // Nothing if the line must not be written; else the number of lines that
  // were not written since the last one that was.
  std::optional<uint64_t> Admit(int64_t now_ns) {
    // Generic cell rate algorithm: each line moves `full_at` by one interval,
    // and it may be at most a burst ahead of now.
    int64_t full_at = full_at_ns_.load();
    int64_t next = 0;
    do {
      next = std::max(full_at, now_ns) + interval_ns_;
      if (next - now_ns > burst_ns_) {
        left_out_.fetch_add(1);
        return std::nullopt;
      }
    } while (!full_at_ns_.compare_exchange_weak(full_at, next));
    return left_out_.exchange(0);
  }

 private:
  const int64_t interval_ns_;
  const int64_t burst_ns_;
  std::atomic<int64_t> full_at_ns_ = 0;
  std::atomic<uint64_t> left_out_ = 0;
};

// What to append to a line: empty, or how many lines were left out before it.
inline std::string LeftOut(uint64_t count) {
  return count == 0 ? "" : absl::StrCat(" (", count, " lines left out before)");
}

}  // namespace tactus::internal::server
