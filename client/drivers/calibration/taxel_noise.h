// File: taxel_noise.h
//
// The noise of each value of an untouched skin, that is of each taxel along
// each axis, and the thresholds of each taxel's load that follow from it by the
// rule of core/skin/idle_thresholds.h. `trainctl skin estimate` applies the
// same rule to all taxels at once.
//
//   const TaxelThresholds thresholds =
//       ThresholdsOf(idle, baseline, AxisLoads(layout, cross_axis));
//   if (load >= thresholds.contact[17]) Touch(17);
//
// Thread-safe: free functions without state.
#pragma once

#include <vector>

#include "client/drivers/calibration/axis_loads.h"
#include "client/drivers/calibration/idle_frames.h"

namespace tactus::internal::client {

struct ValueNoise {
  // Standard deviation, in the numbers that the skin sends.
  double deviation = 0;
  // Fraction of the frames whose value differs from the one before.
  double changes = 0;
};

// The noise of all values. `baseline` has one number per value.
std::vector<ValueNoise> NoiseOf(const IdleFrames& idle,
                                const std::vector<double>& baseline);

// One number per taxel, above the baseline: loads as AxisLoads makes them.
struct TaxelThresholds {
  std::vector<double> contact;
  std::vector<double> onset;
};

// A margin is at least the load of `least_margin` and of one step of the skin's
// numbers.
TaxelThresholds ThresholdsOf(const IdleFrames& idle,
                             const std::vector<double>& baseline,
                             const AxisLoads& loads, double least_margin = 0);

// The noise of each value as a standard deviation, from the median change from
// a frame to the next, so that slow changes and a single step do not count. At
// least 0.3 steps of the skin's numbers and a quarter of the skin's median on
// the same axis. Where these steps are unknown, changes of 0 do not count: a
// skin that sends frames faster than it measures repeats its floats.
std::vector<double> StepNoise(const IdleFrames& idle);

// A Gaussian's standard deviation, divided by its median absolute deviation.
inline constexpr double kDeviationsPerMedian = 1.4826;

// 0 if there are no values.
double MedianOf(std::vector<double> values);

// The median of `numbers`, which has one per value, on each axis. Masked taxels
// do not count.
AxisVector AxisMedians(const IdleFrames& idle,
                       const std::vector<double>& numbers);

}  // namespace tactus::internal::client
