// File: thread_priority.h
//
// How the kernel shares processors between threads that answer robots, those
// that show people what happens, and those that compute for hours. Programs
// choose; the rest of core does not.
//
//   SetThreadPriority(ThreadPriority::kPrompt);      // in main, before threads
//   SetThreadPriority(ThreadPriority::kBackground);  // in a job
//
// Threads and processes inherit the priority of the thread that starts them.
// Thread-safe and async-signal-safe.
#pragma once

namespace tactus::internal {

enum class ThreadPriority {
  // Runs soon after it wakes up, even if background threads keep all processors
  // busy. Asks for time slices of 0.1 ms, which needs no privilege; Linux
  // before 6.12 ignores it. Niceness stays as it is, and so does a real-time
  // policy.
  kPrompt,
  // Niceness 10, or what it is if that is more: shows people what happens, and
  // leaves the processors to robots while they need them.
  kAttendant,
  // Niceness 19 and time slices of 20 ms: all the time that nobody else wants,
  // and a little more, so that it never starves.
  kBackground,
};

// Sets the priority of the calling thread. False if the kernel refuses.
bool SetThreadPriority(ThreadPriority priority);

}  // namespace tactus::internal
