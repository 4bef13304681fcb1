#include "client/drivers/calibration/drift_tracker.h"

#include <cmath>

namespace tactus::internal::client {

DriftTracker::DriftTracker(size_t taxels, const Options& options)
    : weight_(-std::expm1(-1 / (options.time_s * options.sample_rate_hz))),
      hold_frames_(static_cast<uint64_t>(
          std::ceil(options.hold_s * options.sample_rate_hz))),
      drift_(taxels) {}

void DriftTracker::Step(std::span<const double> above_baseline,
                        std::span<const double> contact_thresholds,
                        std::span<const uint8_t> mask) {
  bool touched = false;
  for (size_t i = 0; i < drift_.size() && !touched; ++i) {
    touched = (mask.empty() || mask[i] != 0) &&
              above_baseline[i] - drift_[i] >= contact_thresholds[i];
  }
  if (touched) held_ = hold_frames_ + 1;
  frozen_ = held_ > 0;
  if (frozen_) {
    --held_;
    return;
  }
  for (size_t i = 0; i < drift_.size(); ++i) {
    drift_[i] += weight_ * (above_baseline[i] - drift_[i]);
  }
}

}  // namespace tactus::internal::client
