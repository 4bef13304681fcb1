// File: timing.h
//
// Clocks of the benchmarks, and a way to time our code and a peer in turns, so
// that the machine's other load slows both. The medians of the repetitions
// count.
//
//   const Timing timing = Interleave(15, [&] { Ours(); }, [&] { Theirs(); });
//   row.ours = timing.ours / frames * 1e9;
//
// Benchmarks that compute use processor time: it stops while the machine runs
// another process. Elapsed time would punish the longer work, which is
// interrupted more often. A first round of each warms the caches and does not
// count.
//
// Thread-safe: functions without state.
#pragma once

#include <chrono>
#include <ctime>
#include <type_traits>
#include <vector>

#include "tools/common/percentile.h"

namespace tactus::internal::client {

// Processor time of this thread, s.
inline double ThreadSeconds() {
  timespec time;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * time.tv_nsec;
}

// Elapsed seconds of one call, for work that waits for other processes.
template <typename Work>
double SecondsOf(Work&& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
      .count();
}

// Processor seconds of one call. A call that returns a double returns the
// seconds itself, measured in another process.
template <typename Work>
double ProcessorSecondsOf(Work&& work) {
  if constexpr (std::is_same_v<decltype(work()), double>) {
    return work();
  } else {
    const double start = ThreadSeconds();
    work();
    return ThreadSeconds() - start;
  }
}

// Medians of processor time, s.
struct Timing {
  double ours = 0;
  double peer = 0;
};

// `repetitions` > 0.
template <typename Ours, typename Peer>
Timing Interleave(int repetitions, Ours&& ours, Peer&& peer) {
  ours();
  peer();
  std::vector<double> our_seconds, peer_seconds;
  for (int i = 0; i < repetitions; ++i) {
    our_seconds.push_back(ProcessorSecondsOf(ours));
    peer_seconds.push_back(ProcessorSecondsOf(peer));
  }
  return {Percentile(our_seconds, 0.5), Percentile(peer_seconds, 0.5)};
}

// Median processor seconds of `ours` if there is no peer.
template <typename Ours>
double MedianSeconds(int repetitions, Ours&& ours) {
  return Interleave(repetitions, ours, [] {}).ours;
}

}  // namespace tactus::internal::client
