// File: clock.h
//
// The server's clock, for durations only. It is a separate header so that all
// durations come from one clock. Thread-safe.
#pragma once

#include <chrono>
#include <cstdint>

namespace tactus::internal::server {

inline constexpr int64_t kNsPerMs = 1'000'000;

// Nanoseconds since some fixed point; never goes back.
inline int64_t MonotonicNs() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace tactus::internal::server
