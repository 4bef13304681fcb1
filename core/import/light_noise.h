// File: light_noise.h
//
// What the regions of an untouched skin feel above their background, and the
// settings of light touch that follow from it:
//
//   deviation = root mean square over time of a region's mean, that of the
//               noisiest region
//   onset_threshold = 7 deviations, contact_threshold = 5 deviations
//
//   LightNoise noise(/*frames=*/1000);
//   for (const Trial& trial : trials) noise.Add(trial);
//   if (const auto light = noise.Estimate()) layout.light_touch = *light;
//
// Regions are 3 x 3 taxels, or as much of it as the skin has, over 0.1 s. Not
// thread-safe.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/data/trial.h"
#include "core/skin/layout.h"

namespace tactus::internal {

class LightNoise {
 public:
  // The first `frames` of each trial are idle.
  explicit LightNoise(int frames) : frames_(frames) {}

  // Takes a trial with taxels. One that gives no skin that fits, or another
  // than the trials before, is left out.
  void Add(const Trial& trial);

  // Root mean square of the noisiest region; 0 if there is none.
  double Deviation() const;

  // Nothing if there are less than 200 frames after the first 0.3 s of their
  // trials, or if they have no noise.
  std::optional<LightTouch> Estimate() const;

 private:
  int frames_;
  std::optional<SkinLayout> layout_;
  // Sums over counted_ frames, for each region.
  std::vector<double> squares_;
  size_t counted_ = 0;
};

}  // namespace tactus::internal
