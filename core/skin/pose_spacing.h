// File: pose_spacing.h
//
// PoseSpacing: which of a stream's poses are kept for the estimate at onset
// (recent_poses.h). A client that replays frames to a new stream begins at a
// kept pose that is older than the window. All estimates are then the same.
//
//   PoseSpacing spacing(/*sample_rate_hz=*/100);
//   spacing.Step(/*missing_before=*/0);
//   const bool kept = spacing.Keep();
//
// Owns a few numbers. Nothing allocates. Not thread-safe; one per stream.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tactus::internal {

class PoseSpacing {
 public:
  // `sample_rate_hz` must be above 0.
  explicit PoseSpacing(double sample_rate_hz)
      : spacing_(Frames(0.01, sample_rate_hz)),
        window_(Frames(0.2, sample_rate_hz)) {}

  // Frames after which a pose is too old for the estimate.
  uint64_t window() const { return window_; }
  // Number of the last frame.
  uint64_t frame() const { return frame_; }

  // Forgets all frames.
  void Reset() {
    frame_ = 0;
    any_ = false;
  }

  // Takes the next frame. `missing_before` frames were lost directly before
  // it; if they fill the window, all frames before are forgotten.
  void Step(uint64_t missing_before) {
    // So that frame_ never overflows.
    if (missing_before >= window_) Reset();
    frame_ += std::min(missing_before, window_) + 1;
  }

  // To be called once after Step if the frame has a pose. True if the pose is
  // kept when the next one comes; else the next one replaces it.
  bool Keep() {
    if (any_ && frame_ - kept_ < spacing_) return false;
    any_ = true;
    kept_ = frame_;
    return true;
  }

 private:
  static uint64_t Frames(double seconds, double sample_rate_hz) {
    return static_cast<uint64_t>(
        std::max(1.0, std::round(seconds * sample_rate_hz)));
  }

  // Frames between two kept poses, and frames of the window.
  uint64_t spacing_;
  uint64_t window_;
  uint64_t frame_ = 0;
  // The last kept one, if there is any.
  uint64_t kept_ = 0;
  bool any_ = false;
};

}  // namespace tactus::internal
