// File: frames_trial.h
//
// Frames of a stream as a trial, without id and label.
//
//   const Trial trial = TrialOfFrames(frames, type, scale, rate_hz, layout);
//   if (MissingFrames(frames) > 0) Remark(trial);
//
// Thread-safe: free functions without state.
#pragma once

#include <cstdint>
#include <deque>

#include "core/data/trial.h"
#include "core/skin/layout.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal {

// `frames`: at least one batch; each has one dense frame of the layout's shape,
// encoded as `type` and `scale` say, and all have poses or none. Integers stay
// as they are. Times count from the first frame.
Trial TrialOfFrames(const std::deque<v1::FrameBatch>& frames,
                    v1::TaxelType type, double scale, double rate_hz,
                    const SkinLayout& layout);

// Frames that were lost between them, by their sequence numbers.
uint64_t MissingFrames(const std::deque<v1::FrameBatch>& frames);

// The pose of a batch of one frame, which has one.
Pose PoseOf(const v1::FrameBatch& frame);

}  // namespace tactus::internal
