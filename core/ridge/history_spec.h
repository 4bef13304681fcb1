// File: history_spec.h
//
// HistorySpec: how the frames of a contact become the numbers of a
// TouchHistory (touch_history.h).
//
// A frame's channels are those of FrameViews.
//
// Plain data. Copyable.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "core/ridge/frame_views.h"
#include "core/ridge/mini_kernels.h"
#include "core/ridge/stretches.h"

namespace tactus::internal {

// Numbers of a channel: mean, deviation, largest, smallest, mean step, the
// fraction of frames in which it is not 0, and two running means.
inline constexpr int kHistoryStatistics = 8;
// Channels that a mixture takes at most.
inline constexpr int kMiniMixed = 8;

struct HistorySpec : FrameViews {
  // The series that each kernel reads: a sum over channels, [views][kernels]
  // [kMiniMixed]. A weight of 0 ends it.
  // These, the weights and the thresholds are empty without kernels, and of the
  // sizes that are given else.
  std::vector<uint16_t> mixed_channel;
  std::vector<float> mixed_weight;
  // [views][dilations][thresholds][kernels]
  std::vector<float> threshold;

  bool has_kernels() const { return !threshold.empty(); }
  // Numbers that a contact becomes: one per threshold, and those of channels.
  size_t numbers() const {
    return static_cast<size_t>(channels()) * kFrameViews *
               (kHistoryStatistics + kHistoryStretches) +
           threshold.size();
  }
};

// INVALID_MODEL that names what is wrong.
absl::Status Validate(const HistorySpec& spec);

}  // namespace tactus::internal
