// File: touch_history.h
//
// TouchHistory: all touched frames of a contact so far as numbers of a fixed
// count, which a linear model classifies (ridge.h).
//
//   TouchHistory history(&spec);
//   for (const ContactSample& sample : contact) history.Step(sample.loads);
//   history.Write(numbers);
//
// The numbers are, in this order:
//
// - of each channel (history_spec.h) kHistoryStatistics statistics, one
//   statistic of all channels after the other;
// - of each channel its means over kHistoryStretches stretches (stretches.h),
//   stretch by stretch;
// - of each kernel (mini_kernels.h), dilation and threshold the fraction of
//   frames in which the kernel's value is above the threshold, as
//   HistorySpec::threshold is ordered; none without kernels. Before the first
//   frame the skin is taken to be untouched.
//
// Step and Write allocate nothing; the time of Step does not depend on the
// frames before. The same frames give the same bits on every processor. Refers
// to the spec, which must be valid and outlive it. Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/ridge/history_spec.h"
#include "core/taxels/taxel_load.h"

namespace tactus::internal {

class TouchHistory {
 public:
  explicit TouchHistory(const HistorySpec* spec);

  // Forgets the contact.
  void Reset();

  // Takes the touched taxels of the next touched frame. Taxels beyond those of
  // the skin must not occur.
  void Step(std::span<const TaxelLoad> loads);

  // Frames so far.
  uint64_t frames() const { return frames_; }

  // Writes HistorySpec::numbers() numbers; zeros before the first frame.
  void Write(std::span<float> numbers) const;

  // The same numbers part by part, for callers without room for all of them: a
  // part is one statistic or one stretch of all channels, or all thresholds of
  // a view.
  int parts() const;
  size_t LargestPart() const;
  // Writes the numbers of a part to the first elements of `numbers`, which has
  // LargestPart() of them. Returns how many they are.
  size_t WritePart(int part, std::span<float> numbers) const;

  // The value of each kernel at the last frame, [views][dilations][kMiniLanes];
  // of no meaning before the first.
  std::span<const float> kernel_values() const { return kernel_values_; }

 private:
  void StepKernels();
  void WriteStatistic(int statistic, std::span<float> numbers) const;
  void WriteKernels(int view, std::span<float> numbers) const;

  const HistorySpec* spec_;
  // Channels of all views.
  size_t channels_;
  uint64_t frames_ = 0;
  // One per channel: this frame's and the last one's value.
  std::vector<float> value_;
  std::vector<float> previous_;
  std::vector<double> sum_;
  std::vector<double> square_;
  std::vector<double> steps_;
  std::vector<float> largest_;
  std::vector<float> smallest_;
  std::vector<float> short_mean_;
  std::vector<float> long_mean_;
  std::vector<uint32_t> active_;
  Stretches stretches_;
  // The series of the kernels in the last kMiniReach frames,
  // [views][kMiniReach][kMiniLanes].
  std::vector<float> series_;
  int newest_ = 0;
  std::vector<float> kernel_values_;
  // Frames above each threshold, [views][dilations][thresholds][kMiniLanes].
  std::vector<float> threshold_;
  std::vector<uint32_t> above_;
};

}  // namespace tactus::internal
