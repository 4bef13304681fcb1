// File: rate_watch.h
//
// RateWatch: compares the times of frames with the rate that was stated for
// them, while they come.
//
//   RateWatch watch(/*stated_hz=*/100);
//   if (watch.Add(/*frames=*/1, capture_time_ns)) Tell(watch.measured_hz());
//
// The rate is measured over windows of half a second. A pause, or frames that
// are late once, are in one window; only several windows in a row count, fewer
// if frames come far too slowly. The longest interval of a window is left
// out if the rest is nearer to the stated rate: it is a pause. Frames that are
// known to be lost count as if they had come. Allocates nothing. Not
// thread-safe.
#pragma once

#include <cstdint>

namespace tactus::internal {

class RateWatch {
 public:
  // `stated_hz` is above 0.
  explicit RateWatch(double stated_hz) : stated_hz_(stated_hz) {}

  // Takes `frames` frames, the first of them at `first_ns`, which rises;
  // `lost_before` frames were lost between them and those before. True once:
  // when the rate is found to differ from the stated one by more than 5 %.
  bool Add(uint32_t frames, int64_t first_ns, uint64_t lost_before = 0);
  // The next frame follows a pause.
  void Pause() { last_.frames = 0; }

  // True if Add was true.
  bool differs() const { return differs_; }
  // The rate in the last window; 0 before the first.
  double measured_hz() const { return measured_hz_; }
  double stated_hz() const { return stated_hz_; }

 private:
  // A number of frames and the time from the first of them to the one after
  // the last.
  struct Span {
    double frames = 0;
    double ns = 0;
  };

  void AddSpan(const Span& span);
  double RateOfWindow() const;

  double stated_hz_;
  // The last frames; their time is that of the first one. No frames after a
  // pause.
  struct {
    uint32_t frames = 0;
    int64_t first_ns = 0;
  } last_;
  // The open window, and its longest interval per frame.
  Span window_;
  Span longest_;
  double measured_hz_ = 0;
  // Grows with each window that differs, as long as their direction is the
  // same.
  int doubt_ = 0;
  bool too_fast_ = false;
  bool differs_ = false;
};

}  // namespace tactus::internal
