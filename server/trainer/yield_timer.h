// File: yield_timer.h
//
// Makes threads that compute for hours offer their processor every 0.5 ms.
//
// A kernel may leave a thread of the lowest priority on its processor until
// the next tick, 4 ms later, although a thread that answers a robot waits for
// that processor. A thread that calls sched_yield gives way at once. A timer
// makes the call, so that no computation has to.
//
//   YieldAtIntervals();                            // in main
//   const ParallelFor threads = Yielding(OnThreads(2));
//
// Takes the signal SIGURG of the process. System calls that it interrupts are
// restarted, except for those that wait, such as poll.
#pragma once

#include <cstdint>

#include "core/base/work.h"

namespace tactus::internal::server {

// From now on until its end the calling thread yields at intervals. A second
// call changes nothing. Does nothing if the kernel grants no timer
// (RLIMIT_SIGPENDING). Thread-safe.
void YieldAtIntervals();

// `parallel`, whose threads yield at intervals.
ParallelFor Yielding(ParallelFor parallel);

// How often the calling thread has yielded.
uint64_t YieldsOfThisThread();

}  // namespace tactus::internal::server
