// File: object_estimate.h
//
// Estimates of the object for a planner: its stiffness and how far it has been
// pushed, each with its uncertainty. A network regresses the stiffness on a log
// scale, and the fraction of the arm's motion that moved the object instead of
// deforming it. That fraction does not depend on the speed.
//
//   const ObjectEstimate estimate =
//       DecodeEstimate(mean, deviation, motion_m);
//   estimate.moved_m;
//
// Plain data and free functions without state; thread-safe.
#pragma once

#include <algorithm>
#include <cmath>

namespace tactus::internal {

// Outputs of the network: index 0 and 1.
inline constexpr int kEstimateRegressions = 2;

// Means and standard deviations.
struct ObjectEstimate {
  double log10_stiffness = 0;  // of N/m
  double log10_stiffness_deviation = 0;
  double moved_m = 0;
  double moved_deviation_m = 0;
};

// The target of the first output for an object of `stiffness` > 0 N/m: about -2
// to 3 over the paper's objects.
inline double EncodeStiffness(double stiffness) {
  return (std::log10(stiffness) - 5) / 2;
}

// Below this motion, m, the fraction cannot be measured.
inline constexpr double kMinMotion = 1e-4;

// The target of the second output if the arm has moved by `motion_m` since
// onset and the object by `moved_m`: 0 to about 1.
inline double EncodeMoved(double moved_m, double motion_m) {
  return std::min(moved_m / std::max(motion_m, kMinMotion), 2.0);
}

// Makes an estimate from the two outputs. `motion_m` is the measured motion.
inline ObjectEstimate DecodeEstimate(const double* mean,
                                     const double* deviation, double motion_m) {
  const double motion = std::max(motion_m, kMinMotion);
  return {5 + 2 * mean[0], 2 * deviation[0], std::max(mean[1], 0.0) * motion,
          deviation[1] * motion};
}

}  // namespace tactus::internal
