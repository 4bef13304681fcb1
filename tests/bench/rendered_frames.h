// File: rendered_frames.h
//
// Frames for benchmarks, as the robot's skin would send them: one simulated
// contact at each of several places, or several objects pressed at once, with
// the skin's noise.
//
//   TACTUS_ASSIGN_OR_RETURN(const auto trials, RenderTrials(skin, 8));
//   for (const RenderedTrial& trial : trials) { ... trial.frame(t) ... }
//
// Plain data; owns its arrays. Same arguments, same bits.
#pragma once

#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/sim/skin/skin_model.h"
#include "core/skin/frame.h"

namespace tactus::internal::client {

struct RenderedTrial {
  int taxels = 0;  // per frame
  // One frame after another, in the layout's unit, and one pose per frame.
  std::vector<float> values;
  std::vector<Pose> poses;
  // Number of frames before the touch, which hold noise only.
  int lead_in = 0;

  int frames() const { return static_cast<int>(poses.size()); }
  std::span<const float> taxels_of(int frame) const {
    return std::span(values).subspan(size_t(frame) * taxels, taxels);
  }
  FrameView frame(int frame) const {
    return {.taxels = taxels_of(frame), .pose = &poses[frame]};
  }
};

// `count` trials of the paper's set, with hard and soft objects in turns, at
// places drawn evenly over the skin.
absl::StatusOr<std::vector<RenderedTrial>> RenderTrials(const SkinModel& skin,
                                                        int count);

// The first `count` contacts of the random world that `skin` feels.
absl::StatusOr<std::vector<RenderedTrial>> WorldTrials(const SkinModel& skin,
                                                       int count);

// One trial that presses 1 to 8 small objects at once, far apart on a skin of
// the named models. Its lead-in ends 0.5 s after the touch, when all of them
// are contacts.
absl::StatusOr<RenderedTrial> PressedTrial(const SkinModel& skin, int objects);

}  // namespace tactus::internal::client
