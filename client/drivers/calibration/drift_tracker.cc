#include "client/drivers/calibration/drift_tracker.h"

#include <cmath>

namespace tactus::internal::client {

DriftTracker::DriftTracker(size_t values, const Options& options)
    : weight_(-std::expm1(-1 / (options.time_s * options.sample_rate_hz))),
      hold_frames_(static_cast<uint64_t>(
          std::ceil(options.hold_s * options.sample_rate_hz))),
      drift_(values),
      readings_(values) {}

void DriftTracker::Step(std::span<const double> above_baseline,
                        const TouchThresholds& thresholds,
                        std::span<const uint8_t> mask) {
  for (size_t i = 0; i < drift_.size(); ++i) {
    readings_[i] = above_baseline[i] - drift_[i];
  }
  bool touched = false;
  const size_t taxels = drift_.size() / thresholds.axes();
  for (size_t i = 0; i < taxels && !touched; ++i) {
    touched =
        (mask.empty() || mask[i] != 0) && thresholds.Excess(i, readings_) >= 0;
  }
  if (touched) held_ = hold_frames_ + 1;
  frozen_ = held_ > 0;
  if (frozen_) {
    --held_;
    return;
  }
  for (size_t i = 0; i < drift_.size(); ++i) {
    drift_[i] += weight_ * readings_[i];
  }
}

}  // namespace tactus::internal::client
