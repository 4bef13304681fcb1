// File: drift_tracker.h
//
// DriftTracker: follows slow changes of the baselines of a skin's values, such
// as those of temperature, and never those of a contact.
//
//   DriftTracker drift(values, {.time_s = 60, .sample_rate_hz = 100});
//   drift.Step(above_baseline, TouchThresholds(calibration), mask);
//   const double value = above_baseline[17] - drift.drift()[17];
//
// The drift of each value is a mean over about `time_s`. While some taxel, less
// its drift, is touched (touch_thresholds.h), all drifts stay as they are, and
// so for `hold_s` after that, because a soft skin recovers slowly. A load that
// stays below all thresholds is taken for a drift.
//
// Step allocates nothing. Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "client/drivers/calibration/touch_thresholds.h"

namespace tactus::internal::client {

class DriftTracker {
 public:
  struct Options {
    // Seconds, above 0.
    double time_s = 60;
    double sample_rate_hz = 100;
    double hold_s = 1;
  };

  DriftTracker(size_t values, const Options& options);

  // Takes a frame, in the skin's numbers above the baseline. `mask` is empty or
  // 0 for taxels that do not count.
  void Step(std::span<const double> above_baseline,
            const TouchThresholds& thresholds, std::span<const uint8_t> mask);

  std::span<const double> drift() const { return drift_; }
  // The last frame changed nothing, because of a contact.
  bool frozen() const { return frozen_; }

 private:
  const double weight_;
  const uint64_t hold_frames_;
  std::vector<double> drift_;
  // Above the baseline, less the drift.
  std::vector<double> readings_;
  uint64_t held_ = 0;
  bool frozen_ = false;
};

}  // namespace tactus::internal::client
