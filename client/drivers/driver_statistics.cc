#include "client/drivers/driver_statistics.h"

#include <algorithm>
#include <cmath>

namespace tactus::internal::client {

uint64_t FrameMeter::Add(int64_t capture_ns, int64_t now_ns) {
  uint64_t missing = 0;
  if (!paused_) {
    const int64_t interval = capture_ns - last_capture_ns_;
    // To the nearest number of periods: clocks of skin and host differ.
    const int64_t periods = (interval + period_ns_ / 2) / period_ns_;
    if (periods > 1) {
      missing = static_cast<uint64_t>(periods - 1);
      lost_ += missing;
    } else {
      intervals_ns_[intervals_++ % kWindow] = interval;
    }
  }
  paused_ = false;
  last_capture_ns_ = capture_ns;
  age_ns_ = now_ns - capture_ns;
  longest_age_ns_ = std::max(longest_age_ns_, age_ns_);
  ++frames_;
  return missing;
}

void FrameMeter::Write(DriverStatistics& statistics) const {
  statistics.frames = frames_;
  statistics.lost = lost_;
  statistics.age_ms = static_cast<double>(age_ns_) / 1e6;
  statistics.longest_age_ms = static_cast<double>(longest_age_ns_) / 1e6;
  const size_t count = std::min(intervals_, kWindow);
  if (count == 0) return;
  double sum = 0;
  double squares = 0;
  for (size_t i = 0; i < count; ++i) {
    const double ms = static_cast<double>(intervals_ns_[i]) / 1e6;
    sum += ms;
    squares += ms * ms;
  }
  const double mean = sum / static_cast<double>(count);
  statistics.rate_hz = mean > 0 ? 1e3 / mean : 0;
  statistics.jitter_ms = std::sqrt(
      std::max(0.0, squares / static_cast<double>(count) - mean * mean));
}

}  // namespace tactus::internal::client
