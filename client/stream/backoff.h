// File: backoff.h
//
// Backoff: how long to wait before a failed call is repeated, so that many
// clients of a server that restarts do not all return at once.
//
//   Backoff backoff(seed);
//   while (!Try()) std::this_thread::sleep_for(backoff.Next());
//   backoff.Reset();  // after a success
//
// The waits double from 25 ms to 5 s; each is multiplied by a random number
// from 0.5 to 1. Not thread-safe.
#pragma once

#include <chrono>
#include <cstdint>

#include "core/base/random.h"

namespace tactus::internal::client {

class Backoff {
 public:
  static constexpr std::chrono::milliseconds kFirst{25};
  static constexpr std::chrono::milliseconds kLongest{5'000};

  explicit Backoff(uint64_t seed) : random_(seed) {}

  std::chrono::milliseconds Next();
  void Reset() { longest_ = kFirst; }

 private:
  Random random_;
  std::chrono::milliseconds longest_ = kFirst;
};

}  // namespace tactus::internal::client
