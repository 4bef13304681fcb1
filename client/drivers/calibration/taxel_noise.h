// File: taxel_noise.h
//
// The noise of each taxel of an untouched skin, and the thresholds that follow
// from it by the rule of core/skin/idle_thresholds.h. `trainctl skin estimate`
// applies the same rule to all taxels at once.
//
//   const std::vector<TaxelNoise> noise = NoiseOf(idle, baseline);
//   if (value - baseline[17] >= noise[17].contact_threshold) Touch(17);
//
// Thread-safe: free functions without state.
#pragma once

#include <vector>

#include "client/drivers/calibration/idle_frames.h"

namespace tactus::internal::client {

// In the numbers that the skin sends.
struct TaxelNoise {
  // Standard deviation.
  double deviation = 0;
  // Above the baseline.
  double contact_threshold = 0;
  double onset_threshold = 0;
  // Fraction of the frames whose value differs from the one before.
  double changes = 0;
};

// The noise of all taxels. A margin is at least `least_margin` and one step of
// the skin's numbers.
std::vector<TaxelNoise> NoiseOf(const IdleFrames& idle,
                                const std::vector<double>& baseline,
                                double least_margin = 0);

// The noise of each taxel as a standard deviation, from the median change from
// a frame to the next, so that slow changes and a single step do not count. At
// least 0.3 steps of the skin's numbers and a quarter of the skin's median.
std::vector<double> StepNoise(const IdleFrames& idle);

// A Gaussian's standard deviation, divided by its median absolute deviation.
inline constexpr double kDeviationsPerMedian = 1.4826;

// 0 if there are no values.
double MedianOf(std::vector<double> values);

}  // namespace tactus::internal::client
