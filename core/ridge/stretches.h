// File: stretches.h
//
// Stretches: the means of channels (frame_views.h) over ten stretches of the
// contact so far, all of one length, in constant memory. The frames lie in at
// most 20 blocks of one length; when these are full, neighbours are put
// together.
//
//   Stretches stretches(channels);
//   for (size_t i = 0; i < channels; ++i) stretches.sums()[i] += frame[i];
//   stretches.Step();  // once a frame
//   stretches.Write(numbers);
//
// Allocates nothing after construction. The same frames give the same bits on
// every processor. Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tactus::internal {

inline constexpr int kHistoryStretches = 10;

class Stretches {
 public:
  explicit Stretches(size_t channels);

  // Forgets all frames.
  void Reset();

  // Sums of the block that is filled, one per channel and padded to whole
  // vectors (history_kernels.h); a frame's channels are added to them before
  // its Step.
  std::span<double> sums() { return sum_; }
  void Step();

  // Writes kHistoryStretches means of each channel, stretch by stretch; zeros
  // before the first frame.
  void Write(std::span<float> numbers) const;
  // The same of one stretch.
  void WriteStretch(int stretch, std::span<float> numbers) const;

 private:
  static constexpr int kBlocks = 2 * kHistoryStretches;

  size_t channels_;
  uint64_t frames_ = 0;
  // Means of the full blocks, [kBlocks][channels].
  std::vector<float> mean_;
  std::vector<double> sum_;
  uint64_t block_length_ = 1;
  uint64_t block_frames_ = 0;
  int blocks_ = 0;
};

}  // namespace tactus::internal
