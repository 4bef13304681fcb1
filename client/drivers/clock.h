// File: clock.h
//
// Clock: the time that drivers read and wait by, so that tests need not wait.
//
//   Clock& clock = Clock::System();
//   const int64_t deadline_ns = clock.NowNs() + 500'000'000;
//   while (clock.NowNs() < deadline_ns) clock.SleepNs(1'000'000);
//
// System() is thread-safe and lives until the program ends. Other clocks say
// for themselves.
#pragma once

#include <cstdint>

namespace tactus::internal::client {

class Clock {
 public:
  virtual ~Clock() = default;

  // Nanoseconds; never decreases.
  virtual int64_t NowNs() = 0;
  virtual void SleepNs(int64_t duration_ns) = 0;

  // CLOCK_MONOTONIC.
  static Clock& System();
};

}  // namespace tactus::internal::client
