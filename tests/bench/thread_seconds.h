// File: thread_seconds.h
//
// The clock of benchmarks that compute: unlike the time elapsed, it stands
// still while the machine gives the processor to something else.
//
//   const double start = ThreadSeconds();
//   Work();
//   const double seconds = ThreadSeconds() - start;
//
// Thread-safe.
#pragma once

#include <ctime>

namespace tactus::client {

// Processor time of this thread, s.
inline double ThreadSeconds() {
  timespec time;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * time.tv_nsec;
}

}  // namespace tactus::client
