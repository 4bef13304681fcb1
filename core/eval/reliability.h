// File: reliability.h
//
// ReliabilityBins: how often answers were right, by the probability that they
// had. An answer with probability 0.8 should be right in eight of ten contacts.
//
//   for (const ReliabilityBin& bin : ReliabilityBins(evaluation.final)) {
//     const Interval right = WilsonInterval(bin.right, bin.count);
//     draw(bin.mean_probability, right);
//   }
//
// Plain data and a free function without state; thread-safe.
#pragma once

#include <span>
#include <vector>

#include "core/eval/metrics.h"

namespace tactus::internal {

inline constexpr int kReliabilityBins = 15;

// Outcomes whose top probability falls into one of kReliabilityBins bins of
// equal width, those of ExpectedCalibrationError.
struct ReliabilityBin {
  // Bounds of the top probability.
  double low = 0;
  double high = 0;
  double mean_probability = 0;
  int right = 0;
  int count = 0;
};

// Bins that hold an outcome, by increasing probability.
std::vector<ReliabilityBin> ReliabilityBins(std::span<const Outcome> outcomes);

}  // namespace tactus::internal
