// File: contact_time.h
//
// How long a contact is: n frames of contact last n frame intervals, because
// each frame stands for the time until the next one. A touch that is felt in
// 200 frames at 100 Hz is 2 s long, in every program.
//
//   ContactSeconds(/*frames=*/200, /*rate_hz=*/100);  // 2
//   FramesIn(/*seconds=*/2, /*rate_hz=*/100);    // 200
//
// Stateless; thread-safe.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tactus::internal {

// `frames` count from 1 at the onset.
inline double ContactSeconds(uint64_t frames, double rate_hz) {
  return static_cast<double>(frames) / rate_hz;
}

// The nearest number of frames, at least 1.
inline uint64_t FramesIn(double seconds, double rate_hz) {
  return static_cast<uint64_t>(std::max(1.0, std::round(seconds * rate_hz)));
}

}  // namespace tactus::internal
