// File: interleave.h
//
// Times two ways to do the same work in turns, so that what else the machine
// does falls on both; medians of the repetitions count.
//
//   const Timing timing = Interleave(15, [&] { Ours(); }, [&] { Theirs(); });
//   row.ours = timing.ours / frames * 1e9;
//
// Processor time: of the time elapsed, the longer work loses more to other
// processes, however they take turns. A first round of each warms caches and
// does not count.
#pragma once

#include <chrono>
#include <type_traits>
#include <vector>

#include "client/stream/percentile.h"
#include "tests/bench/thread_seconds.h"

namespace tactus::client {

// Seconds that pass during one call, for work that waits for others.
template <typename Work>
double SecondsOf(Work&& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
      .count();
}

// Seconds that the processor works on one call, or those it returns as measured
// by another process.
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

// Ours alone, where there is no peer to be had.
template <typename Ours>
double MedianSeconds(int repetitions, Ours&& ours) {
  return Interleave(repetitions, ours, [] {}).ours;
}

}  // namespace tactus::client
