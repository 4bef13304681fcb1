#include "core/base/rate_watch.h"

#include <cmath>

namespace tactus {
namespace {

// As a stream's rate may differ from its model's.
constexpr double kMostDifference = 0.05;
constexpr int64_t kWindowNs = 1'000'000'000;
// A slow skin sends few frames in a second.
constexpr uint64_t kLeastFrames = 5;
constexpr int kWindows = 3;

}  // namespace

bool RateWatch::Add(uint32_t frames, int64_t first_ns) {
  if (frames_ == 0) begin_ns_ = first_ns;
  const int64_t elapsed_ns = first_ns - begin_ns_;
  const bool complete =
      frames_ >= kLeastFrames && elapsed_ns > 0 &&
      (elapsed_ns >= kWindowNs || static_cast<double>(frames_) >= stated_hz_);
  if (complete) {
    measured_hz_ =
        static_cast<double>(frames_) * 1e9 / static_cast<double>(elapsed_ns);
    const bool differs =
        std::abs(measured_hz_ / stated_hz_ - 1) > kMostDifference;
    windows_that_differ_ = differs ? windows_that_differ_ + 1 : 0;
    begin_ns_ = first_ns;
    frames_ = 0;
  }
  frames_ += frames;
  if (differs_ || windows_that_differ_ < kWindows) return false;
  differs_ = true;
  return true;
}

}  // namespace tactus
