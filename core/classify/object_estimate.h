// File: object_estimate.h
//
// What a planner wants beside the class: how stiff the object is and how far
// it has been pushed, each with its uncertainty. A network regresses both: the
// stiffness on a log scale, and the share of the arm's motion that moved the
// object instead of deforming it, which holds at any speed.
//
// Plain data and free functions without state; thread-safe.
#pragma once

#include <algorithm>
#include <cmath>

namespace tactus {

// Outputs of the network: index 0 and 1.
inline constexpr int kEstimateRegressions = 2;

// Means and standard deviations.
struct ObjectEstimate {
  double log10_stiffness = 0;  // of N/m
  double log10_stiffness_deviation = 0;
  double moved_m = 0;
  double moved_deviation_m = 0;
};

// What the first output should say of an object of `stiffness` > 0 N/m: about
// -2 to 3 over the paper's objects.
inline double EncodeStiffness(double stiffness) {
  return (std::log10(stiffness) - 5) / 2;
}

// Motion below this tells nothing of shares, m.
inline constexpr double kLeastMotion = 1e-4;

// What the second output should say when the arm has moved by `motion_m` since
// onset and the object by `moved_m`: 0 to about 1.
inline double EncodeMoved(double moved_m, double motion_m) {
  return std::min(moved_m / std::max(motion_m, kLeastMotion), 2.0);
}

// Reads the two outputs; `motion_m` as measured.
inline ObjectEstimate DecodeEstimate(const double* mean,
                                     const double* deviation, double motion_m) {
  const double motion = std::max(motion_m, kLeastMotion);
  return {5 + 2 * mean[0], 2 * deviation[0], std::max(mean[1], 0.0) * motion,
          deviation[1] * motion};
}

}  // namespace tactus
