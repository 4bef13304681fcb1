// File: idle_frames.h
//
// IdleFrames: frames of an untouched skin, in the numbers that the skin sends,
// from which a calibration is made.
//
//   IdleFrames idle(info, /*frames=*/100);
//   while (!idle.complete()) {
//     TACTUS_ASSIGN_OR_RETURN(const ReadResult result, driver.Read(frame));
//     if (result == ReadResult::kFrame) idle.Add(frame);
//   }
//   const std::vector<float> value = idle.Series(17);
//
// A frame has a value per taxel and axis, in the order of
// core/skin/layout.h.
//
// Memory: 4 bytes per value and frame. Not thread-safe.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "client/stream/skin_frame.h"

namespace tactus::internal::client {

class IdleFrames {
 public:
  // Up to `frames` frames of the skin that `info` describes.
  IdleFrames(const SkinInfo& info, size_t frames);

  // Takes a frame; without effect once complete.
  void Add(const SkinFrame& frame);
  bool complete() const { return count_ == frames_; }

  size_t frames() const { return count_; }
  size_t taxels() const { return values_per_frame_ / axes_; }
  size_t axes() const { return axes_; }
  // Values of a frame.
  size_t values() const { return values_per_frame_; }
  size_t TaxelOf(size_t value) const { return value / axes_; }
  // A touch may move a value either way: the layout has three axes, or signs.
  bool both_ways() const { return axes_ > 1 || info_.layout.signed_values; }
  // False for taxels that the layout masks.
  bool valid(size_t taxel) const {
    return info_.layout.mask.empty() || info_.layout.mask[taxel] != 0;
  }
  // The smallest difference of two readings: 1 if the skin sends whole numbers,
  // else 0, which stands for unknown.
  double resolution() const;
  const SkinInfo& info() const { return info_; }
  // The values of one frame, and one value in all frames.
  std::span<const float> Frame(size_t frame) const {
    return {&values_[frame * values_per_frame_], values_per_frame_};
  }
  std::vector<float> Series(size_t value) const;

 private:
  const SkinInfo info_;
  const size_t frames_;
  const size_t axes_;
  const size_t values_per_frame_;
  size_t count_ = 0;
  // frames x taxels x axes
  std::vector<float> values_;
};

// Writes the numbers of a frame, as the skin sent them, to `values`, which has
// room for those of all axes.
void RawValues(const SkinInfo& info, const SkinFrame& frame,
               std::span<float> values);

}  // namespace tactus::internal::client
