// File: idle_thresholds.h
//
// Thresholds from the values that an untouched skin reports:
//
//   q = 99.9th percentile of the values
//   margin = the larger of (q - median) / 2 and `least_margin`
//   contact_threshold = q + margin, onset_threshold = q + 2 margin
//
//   const double median = IdleQuantile(values, 0.5);
//   const double high = IdleQuantile(values, kIdleFraction);
//   const IdleThresholds found = ThresholdsAbove(median, high, 1);
//
// Thread-safe: free functions without state.
#pragma once

#include <vector>

namespace tactus::internal {

inline constexpr double kIdleFraction = 0.999;

struct IdleThresholds {
  double margin = 0;
  double contact_threshold = 0;
  double onset_threshold = 0;
};

IdleThresholds ThresholdsAbove(double median, double high, double least_margin);

// The smallest value that a fraction above `fraction` of the values does not
// exceed; the largest value at most. There is at least one value.
double IdleQuantile(std::vector<float> values, double fraction);
double IdleQuantile(std::vector<double> values, double fraction);

}  // namespace tactus::internal
