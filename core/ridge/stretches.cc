#include "core/ridge/stretches.h"

#include <algorithm>

#include "core/ridge/history_kernels.h"

namespace tactus::internal {

Stretches::Stretches(size_t channels)
    : channels_(channels),
      mean_(channels * kBlocks),
      sum_(PaddedChannels(channels)) {}

void Stretches::Reset() {
  std::ranges::fill(sum_, 0.0);
  frames_ = 0;
  block_length_ = 1;
  block_frames_ = 0;
  blocks_ = 0;
}

void Stretches::Step() {
  ++frames_;
  if (++block_frames_ < block_length_) return;
  const double per_frame = 1 / static_cast<double>(block_length_);
  float* const mean = mean_.data() + blocks_ * channels_;
  for (size_t i = 0; i < channels_; ++i) {
    mean[i] = static_cast<float>(sum_[i] * per_frame);
    sum_[i] = 0;
  }
  block_frames_ = 0;
  if (++blocks_ < kBlocks) return;
  for (int b = 0; b < kBlocks / 2; ++b) {
    const float* const two = mean_.data() + 2 * b * channels_;
    float* const one = mean_.data() + b * channels_;
    for (size_t i = 0; i < channels_; ++i) {
      one[i] = 0.5F * (two[i] + two[channels_ + i]);
    }
  }
  blocks_ = kBlocks / 2;
  block_length_ *= 2;
}

void Stretches::Write(std::span<float> numbers) const {
  for (int j = 0; j < kHistoryStretches; ++j) {
    WriteStretch(j, numbers.subspan(j * channels_, channels_));
  }
}

void Stretches::WriteStretch(int stretch, std::span<float> numbers) const {
  std::ranges::fill(numbers, 0.0F);
  if (frames_ == 0) return;
  const auto block = static_cast<double>(block_length_);
  const double length = static_cast<double>(frames_) / kHistoryStretches;
  const double begin = stretch * length;
  const double end = begin + length;
  for (int b = 0; b < blocks_; ++b) {
    const double shared =
        std::min(end, (b + 1) * block) - std::max(begin, b * block);
    if (shared <= 0) continue;
    AddScaled(static_cast<float>(shared / length), mean_.data() + b * channels_,
              channels_, numbers.data());
  }
  // The block that is filled.
  const double shared = end - std::max(begin, blocks_ * block);
  if (block_frames_ == 0 || shared <= 0) return;
  const double weight = shared / (length * static_cast<double>(block_frames_));
  for (size_t i = 0; i < channels_; ++i) {
    numbers[i] += static_cast<float>(weight * sum_[i]);
  }
}

}  // namespace tactus::internal
