// File: ridge_samples.h
//
// Made-up contacts on a small skin, and specs that read them. Test-only.
//
//   const Frames frames = RandomFrames(spec, 100, random);
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/random.h"
#include "core/ridge/history_spec.h"
#include "core/taxels/taxel_load.h"

namespace tactus::internal::testing {

using Frames = std::vector<std::vector<TaxelLoad>>;

inline std::vector<std::span<const TaxelLoad>> Views(const Frames& frames) {
  return {frames.begin(), frames.end()};
}

// A valid spec with random mixtures and thresholds.
inline HistorySpec RandomSpec(int rows, int columns, Random& random) {
  HistorySpec spec;
  spec.rows = rows;
  spec.columns = columns;
  spec.block = HistoryBlock(spec.shape());
  spec.scale = {0.5F, 2, 0.25F};
  const size_t mixed = size_t{kFrameViews} * kMiniKernels * kMiniMixed;
  for (size_t i = 0; i < mixed; ++i) {
    spec.mixed_channel.push_back(
        static_cast<uint16_t>(random.Index(spec.channels())));
    // A kernel of three channels on average.
    const bool ends = i % kMiniMixed > 0 && random.Index(3) == 0;
    spec.mixed_weight.push_back(ends ? 0
                                     : static_cast<float>(random.Gaussian()));
  }
  const size_t thresholds =
      size_t{kFrameViews} * kMiniDilationCount * kMiniThresholds * kMiniKernels;
  for (size_t i = 0; i < thresholds; ++i) {
    spec.threshold.push_back(static_cast<float>(random.Gaussian()));
  }
  return spec;
}

// Frames in which some taxels are touched, at least one.
inline Frames RandomFrames(const HistorySpec& spec, size_t count,
                           Random& random) {
  Frames frames(count);
  for (auto& frame : frames) {
    const int taxels = spec.rows * spec.columns;
    for (int taxel = 0; taxel < taxels; ++taxel) {
      if (random.Index(3) > 0 && (taxel + 1 < taxels || !frame.empty())) {
        continue;
      }
      frame.push_back({static_cast<uint32_t>(taxel),
                       static_cast<float>(random.Uniform(0.1, 3))});
    }
  }
  return frames;
}

}  // namespace tactus::internal::testing
