// File: run_on_threads.h
//
// Spreads independent work over all processors. The programs and benchmarks
// lend their threads to core with it, because core starts none
// (core/base/work.h).
//
//   RunOnThreads(jobs.size(), [&](int i) { results[i] = Run(jobs[i]); });
//   FitModel(contacts, options, RunOnThreads);
//   FitModel(contacts, options, OnThreads(2));
//
// Threads exist only during the call. The order of the calls varies between
// runs, so results should go to places that depend on the argument alone; then
// the same input gives the same bits on any number of processors.
//
// Thread-safe. `body` runs on several threads at once: calls with different
// arguments must not write to the same object.
#pragma once

#include <functional>

namespace tactus::internal {

// Calls body(0) .. body(count - 1), one thread per processor, in any order.
// Returns when all calls have returned. The calling thread takes part.
void RunOnThreads(int count, const std::function<void(int)>& body);

// Does the same with `threads` threads, at least 1.
std::function<void(int count, const std::function<void(int)>& body)> OnThreads(
    int threads);

}  // namespace tactus::internal
