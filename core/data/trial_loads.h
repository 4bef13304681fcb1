// File: trial_loads.h
//
// TrialLoads: the frames of a trial as one load per taxel, whatever the axes of
// its skin.
//
//   TrialLoads loads(trial.taxels, skin);
//   for (size_t t = 0; t < trial.taxels.frames(); ++t) {
//     Use(loads.Frame(t));
//     tracker.Step({.taxels = loads.values()});
//   }
//
// Refers to the frames, which must outlive it; owns room for one of them. Not
// thread-safe.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/data/trial.h"
#include "core/skin/layout.h"
#include "core/skin/normal_loads.h"

namespace tactus::internal {

class TrialLoads {
 public:
  // `skin` is that of the frames.
  TrialLoads(const TaxelSeries& taxels, const SkinLayout& skin)
      : taxels_(taxels), loads_(skin), values_(taxels.frame_size()) {}

  // The loads of frame `index`, one per taxel; valid until the next call.
  std::span<const float> Frame(size_t index) {
    taxels_.Decode(index, values_.data());
    return loads_.Of(values_);
  }
  // The values of all axes of that frame.
  std::span<const float> values() const { return values_; }

 private:
  const TaxelSeries& taxels_;
  NormalLoads loads_;
  std::vector<float> values_;
};

}  // namespace tactus::internal
