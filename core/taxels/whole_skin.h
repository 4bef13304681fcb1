// File: whole_skin.h
//
// WholeSkinTracker: describes the load on the whole skin without saying where
// it is, for skins that are touched anywhere. All numbers are sums over the
// touched taxels. They do not jump when a contact breaks into regions, and the
// order of the taxels does not matter.
//
//   WholeSkinTracker tracker(/*taxels=*/384, /*sample_rate_hz=*/100);
//   tracker.Step(sample.loads);
//   const double root_force = tracker.numbers().root_force;
//
// Below, the pattern of a frame is each taxel's share of the whole load. Half
// of the summed differences between two patterns is the share of the load that
// lies elsewhere: 0 if they are equal, 1 if no taxel is loaded in both. A press
// keeps its pattern, and an object that slides along the skin changes it.
//
// Owns its memory, which is constant; Step allocates nothing. Not thread-safe:
// one per stream.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/taxels/taxel_load.h"

namespace tactus::internal {

class WholeSkinTracker {
 public:
  // Running means over 50 ms. Logarithms are natural.
  struct Numbers {
    // Root of the load on the whole skin, in the root of the layout's unit.
    double root_force = 0;
    // Root of the number of touched taxels.
    double root_taxels = 0;
    // The largest taxel's share of the load.
    double peak_share = 0;
    // Log of the number of taxels that would share the load equally:
    // (sum f)^2 / sum f^2.
    double log_spread = 0;
    // These four less their running means over 0.4 s.
    double force_rate = 0;
    double taxels_rate = 0;
    double peak_share_rate = 0;
    double spread_rate = 0;
    // Log of the share of the load that lies elsewhere than in the mean pattern
    // of the last 0.1 s and 0.4 s, and in the mean of the first 0.1 s.
    double change_short = 0;
    double change_long = 0;
    double change_since_onset = 0;
    // Log of the sum of the changes of the pattern, smoothed over 0.1 s, from
    // frame to frame since onset.
    double log_travel = 0;
  };

  // `sample_rate_hz` above 0.
  WholeSkinTracker(int taxels, double sample_rate_hz);

  // Forgets the contact.
  void Reset();

  // Takes the touched taxels of the next touched frame.
  void Step(std::span<const TaxelLoad> loads);

  const Numbers& numbers() const { return numbers_; }

 private:
  static constexpr int kLevels = 4;

  // Weight of the newest frame in a running mean over `window` frames.
  double Weight(double window) const;
  void StepLevels(std::span<const TaxelLoad> loads, double force);
  void StepPatterns(std::span<const TaxelLoad> loads, double force);

  // Lengths in frames, at least 1.
  double smooth_window_;
  double short_window_;
  double long_window_;
  uint64_t frames_ = 0;
  Numbers numbers_;
  double smooth_[kLevels] = {};
  double slow_[kLevels] = {};
  double smooth_change_[3] = {};
  double travel_ = 0;
  // One share per taxel: of this frame, and means.
  std::vector<float> pattern_;
  std::vector<float> short_mean_;
  std::vector<float> long_mean_;
  std::vector<float> first_mean_;
};

}  // namespace tactus::internal
