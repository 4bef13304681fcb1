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
//   const std::vector<float> taxel = idle.Series(17);
//
// Memory: 4 bytes per taxel and frame. Not thread-safe.
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
  size_t taxels() const { return taxels_; }
  // False for taxels that the layout masks.
  bool valid(size_t taxel) const {
    return info_.layout.mask.empty() || info_.layout.mask[taxel] != 0;
  }
  // The smallest difference of two readings: 1 if the skin sends whole numbers,
  // else 0, which stands for unknown.
  double resolution() const;
  const SkinInfo& info() const { return info_; }
  // The values of one frame, and of one taxel in all frames.
  std::span<const float> Frame(size_t frame) const {
    return {&values_[frame * taxels_], taxels_};
  }
  std::vector<float> Series(size_t taxel) const;

 private:
  const SkinInfo info_;
  const size_t frames_;
  const size_t taxels_;
  size_t count_ = 0;
  // frames x taxels
  std::vector<float> values_;
};

// Writes the numbers of a frame, as the skin sent them, to `values`, which has
// room for those of all axes.
void RawValues(const SkinInfo& info, const SkinFrame& frame,
               std::span<float> values);

}  // namespace tactus::internal::client
