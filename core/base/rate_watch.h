// File: rate_watch.h
//
// RateWatch: compares the times of frames with the rate that was stated for
// them, while they come.
//
//   RateWatch watch(/*stated_hz=*/100);
//   if (watch.Add(/*frames=*/1, capture_time_ns)) Tell(watch.measured_hz());
//
// The rate is measured over windows of a second. A pause, or frames that are
// late once, are in one window; only three windows in a row count. Allocates
// nothing. Not thread-safe.
#pragma once

#include <cstdint>

namespace tactus {

class RateWatch {
 public:
  // `stated_hz` is above 0.
  explicit RateWatch(double stated_hz) : stated_hz_(stated_hz) {}

  // Takes `frames` frames, the first of them at `first_ns`. True once: when
  // the rate is found to differ from the stated one by more than 5 %.
  bool Add(uint32_t frames, int64_t first_ns);
  // The next frame follows a pause.
  void Pause() { frames_ = 0; }

  // True if Add was true.
  bool differs() const { return differs_; }
  // Of the last window; 0 before the first.
  double measured_hz() const { return measured_hz_; }
  double stated_hz() const { return stated_hz_; }

 private:
  double stated_hz_;
  // Of the open window.
  int64_t begin_ns_ = 0;
  uint64_t frames_ = 0;
  double measured_hz_ = 0;
  int windows_that_differ_ = 0;
  bool differs_ = false;
};

}  // namespace tactus
