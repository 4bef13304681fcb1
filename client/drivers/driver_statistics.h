// File: driver_statistics.h
//
// DriverStatistics: how well frames come from a skin; FrameMeter: measures it.
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
#include <string>
#include <vector>

namespace tactus::client {

struct DriverStatistics {
  // Whole frames that the skin delivered, and frames that should have come
  // between them.
  uint64_t frames = 0;
  uint64_t lost = 0;
  // Whole frames that were dropped because their pose was not known; the next
  // frame's gap counts them in `lost`.
  uint64_t without_pose = 0;
  // Parts of lost frames came: boards' scans that were not complete.
  uint64_t incomplete = 0;
  // Frames that nobody read in time (BufferedDriver); they are not in `lost`.
  uint64_t overwritten = 0;
  // Breaks in the connection after which frames came again.
  uint64_t reconnects = 0;
  // Frames per second, and the standard deviation of the time between frames.
  double rate_hz = 0;
  double jitter_ms = 0;
  // From capture to Read, of the last frame, and the longest so far.
  double age_ms = 0;
  double longest_age_ms = 0;
  // False between a break and the next frame.
  bool connected = false;
  // The last reason for a break; stays after it.
  std::string problem;
  // Why frames are dropped for want of a pose, while this goes on.
  std::string pose_problem;
  // Why frames that came whole were refused; empty if none were.
  std::string refused;
  // What was found when the skin was configured, e.g. masked triangles.
  std::string remarks;
  // Taxels, row-major, that have read the same value above 0 for 10 s.
  std::vector<int> stuck_taxels;
};

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

}  // namespace tactus::client
