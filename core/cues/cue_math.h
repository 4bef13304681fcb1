// File: cue_math.h
//
// Numbers that cues are made from: floored logarithms and running means.
//
//   RunningMean mean;
//   mean.Step(step.x[kNetForce], step.Weight(window));
//   cues[0] = LogAbove(mean.value, kForceFloor);
//
// Plain data and pure functions; thread-safe.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/features/feature.h"

namespace tactus::internal {

// Floors of the logarithms: N, m^2, m, fractions of a mean.
inline constexpr double kForceFloor = 1e-6;
inline constexpr double kAreaFloor = 1e-7;
inline constexpr double kMotionFloor = 1e-7;
inline constexpr double kRippleFloor = 1e-6;
// Samples are clamped to plus and minus this, so that no product overflows.
inline constexpr double kLargestSample = 1e30;
// A signal whose deviation is a smaller fraction of its mean does not change:
// the rest is rounding.
inline constexpr double kRoundingFraction = 1e-7;

inline double ClampSample(double x) {
  return std::clamp(x, -kLargestSample, kLargestSample);
}

inline double LogAbove(double x, double floor) {
  return std::log(std::max(x, floor));
}

// Nearly linear below `knee`, logarithmic above; keeps the sign.
inline double SignedLog(double x, double knee) {
  return std::copysign(std::log1p(std::abs(x) / knee), x);
}

// Returns 0 for 0 / 0, because a sum of squares may be 0.
inline double Ratio(double x, double y) { return y > 0 ? x / y : 0; }

// Mean of all samples; a running mean once they are more than a window.
struct RunningMean {
  double value = 0;
  void Step(double x, double weight) { value += weight * (x - value); }
};

// Means, variances and covariances of net force, area and motion, updated as
// RunningMean.
struct RunningMoments {
  FeatureVector mean = {};
  FeatureVector variance = {};
  double force_motion = 0;
  double force_area = 0;

  void Step(const FeatureVector& x, double weight) {
    constexpr int kF = static_cast<int>(Feature::kForce);
    FeatureVector change;
    for (int i = 0; i < kFeatureCount; ++i) {
      change[i] = x[i] - mean[i];
      mean[i] += weight * change[i];
    }
    const double keep = 1 - weight;
    for (int i = 0; i < kFeatureCount; ++i) {
      variance[i] = keep * (variance[i] + weight * change[i] * change[i]);
    }
    force_motion =
        keep * (force_motion + weight * change[kF] *
                                   change[static_cast<int>(Feature::kMotion)]);
    force_area =
        keep * (force_area +
                weight * change[kF] * change[static_cast<int>(Feature::kArea)]);
  }
};

}  // namespace tactus::internal
