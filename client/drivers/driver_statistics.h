// File: driver_statistics.h
//
// FrameMeter: measures how well frames come from a skin, for DriverStatistics
// (tactus/driver.h).
//
//   FrameMeter meter(/*period_ns=*/20'000'000);
//   frame.missing_before = meter.Add(frame.capture_time_ns, clock.NowNs());
//   meter.Write(statistics);
//
// Rate and jitter are those of the last 256 frames; a gap of lost frames counts
// in neither. FrameMeter allocates nothing after its constructor. Not
// thread-safe.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "tactus/driver.h"

namespace tactus::internal::client {

class FrameMeter {
 public:
  explicit FrameMeter(int64_t period_ns) : period_ns_(period_ns) {}

  // Takes a frame's capture time, which rises, and when it was handed on.
  // Returns the number of frames lost between the one before and this one.
  uint64_t Add(int64_t capture_ns, int64_t now_ns);
  // The skin was stopped: what it does not send until the next frame is not
  // lost.
  void Pause() { paused_ = true; }
  // Fills in frames, lost, rate, jitter and ages.
  void Write(DriverStatistics& statistics) const;

 private:
  static constexpr size_t kWindow = 256;

  const int64_t period_ns_;
  uint64_t frames_ = 0;
  uint64_t lost_ = 0;
  // No frame came before the next one.
  bool paused_ = true;
  int64_t last_capture_ns_ = 0;
  int64_t age_ns_ = 0;
  int64_t longest_age_ns_ = 0;
  std::array<int64_t, kWindow> intervals_ns_ = {};
  size_t intervals_ = 0;
};

}  // namespace tactus::internal::client
