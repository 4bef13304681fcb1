#include "core/ridge/touch_history.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/ridge/history_kernels.h"

namespace tactus::internal {
namespace {

// Frames of the two running means.
constexpr float kShortFrames = 8;
constexpr float kLongFrames = 32;
// Below it, the logarithm of the whole load says nothing.
constexpr float kLeastLoad = 1e-12F;

constexpr size_t kKernelLanes =
    size_t{kHistoryViews} * kMiniDilationCount * kMiniLanes;
constexpr size_t kViewSeries = size_t{kMiniReach} * kMiniLanes;

size_t Padded(size_t channels) {
  return (channels + kChannelPadding - 1) / kChannelPadding * kChannelPadding;
}

// Weight of the newest frame in a running mean over `window` frames: a plain
// mean until there are as many.
float MeanWeight(uint64_t frames, float window) {
  return 1 / std::min(static_cast<float>(frames), window);
}

}  // namespace

TouchHistory::TouchHistory(const HistorySpec* spec)
    : spec_(spec),
      channels_(static_cast<size_t>(spec->channels()) * kHistoryViews) {
  const size_t padded = Padded(channels_);
  for (auto* numbers : {&value_, &previous_, &largest_, &smallest_,
                        &short_mean_, &long_mean_}) {
    numbers->resize(padded);
  }
  for (auto* sums : {&sum_, &square_, &steps_, &block_sum_}) {
    sums->resize(padded);
  }
  active_.resize(padded);
  block_mean_.resize(channels_ * kBlocks);
  series_.resize(kViewSeries * kHistoryViews);
  kernel_values_.resize(kKernelLanes);
  above_.resize(kKernelLanes * kMiniThresholds);
  // As the kernels read them; nothing is above those of the padding.
  threshold_.assign(above_.size(), std::numeric_limits<float>::infinity());
  for (size_t row = 0; row < spec->threshold.size() / kMiniKernels; ++row) {
    std::copy_n(spec->threshold.begin() + row * kMiniKernels, kMiniKernels,
                threshold_.begin() + row * kMiniLanes);
  }
  Reset();
}

void TouchHistory::Reset() {
  frames_ = 0;
  for (auto* numbers : {&value_, &previous_, &short_mean_, &long_mean_}) {
    std::ranges::fill(*numbers, 0.0F);
  }
  for (auto* sums : {&sum_, &square_, &steps_, &block_sum_}) {
    std::ranges::fill(*sums, 0.0);
  }
  std::ranges::fill(largest_, std::numeric_limits<float>::lowest());
  std::ranges::fill(smallest_, std::numeric_limits<float>::max());
  std::ranges::fill(active_, 0U);
  std::ranges::fill(series_, 0.0F);
  std::ranges::fill(above_, 0U);
  block_length_ = 1;
  block_frames_ = 0;
  blocks_ = 0;
  newest_ = 0;
}

void TouchHistory::Step(std::span<const TaxelLoad> loads) {
  previous_.swap(value_);
  ReadFrame(loads);
  // There is no step before the first frame.
  if (frames_ == 0) previous_ = value_;
  ++frames_;
  AddChannels(value_.data(), value_.size(),
              {.previous = previous_.data(),
               .sum = sum_.data(),
               .square = square_.data(),
               .steps = steps_.data(),
               .largest = largest_.data(),
               .smallest = smallest_.data(),
               .short_mean = short_mean_.data(),
               .long_mean = long_mean_.data(),
               .active = active_.data(),
               .block = block_sum_.data(),
               .short_weight = MeanWeight(frames_, kShortFrames),
               .long_weight = MeanWeight(frames_, kLongFrames)});
  StepBlocks();
  StepKernels();
}

void TouchHistory::ReadFrame(std::span<const TaxelLoad> loads) {
  std::ranges::fill(value_, 0.0F);
  const auto cells = static_cast<size_t>(spec_->cells());
  const std::span<float> raw(value_.data(), cells + 1);
  const std::span<float> root(raw.data() + cells + 1, cells + 1);
  const std::span<float> shape(root.data() + cells + 1, cells + 1);
  float whole = 0;
  for (const TaxelLoad& load : loads) {
    const float value = load.root * load.root;
    raw[spec_->CellOf(load.taxel)] += value;
    whole += value;
  }
  raw[cells] = whole;
  const float per_whole = 1 / std::sqrt(std::max(whole, kLeastLoad));
  for (size_t i = 0; i <= cells; ++i) {
    root[i] = std::sqrt(raw[i]);
    shape[i] = root[i] * per_whole;
  }
  shape[cells] = std::log(std::max(whole, kLeastLoad));
  for (int view = 0; view < kHistoryViews; ++view) {
    const float scale = spec_->scale[view];
    for (float& x : std::span(value_).subspan(view * (cells + 1), cells + 1)) {
      x *= scale;
    }
  }
}

void TouchHistory::StepBlocks() {
  if (++block_frames_ < block_length_) return;
  const double per_frame = 1 / static_cast<double>(block_length_);
  float* const mean = block_mean_.data() + blocks_ * channels_;
  for (size_t i = 0; i < channels_; ++i) {
    mean[i] = static_cast<float>(block_sum_[i] * per_frame);
    block_sum_[i] = 0;
  }
  block_frames_ = 0;
  if (++blocks_ < kBlocks) return;
  for (int b = 0; b < kBlocks / 2; ++b) {
    const float* const two = block_mean_.data() + 2 * b * channels_;
    float* const one = block_mean_.data() + b * channels_;
    for (size_t i = 0; i < channels_; ++i) {
      one[i] = 0.5F * (two[i] + two[channels_ + i]);
    }
  }
  blocks_ = kBlocks / 2;
  block_length_ *= 2;
}

void TouchHistory::StepKernels() {
  newest_ = newest_ == 0 ? kMiniReach - 1 : newest_ - 1;
  const size_t view_channels = channels_ / kHistoryViews;
  for (int view = 0; view < kHistoryViews; ++view) {
    float* const series = series_.data() + view * kViewSeries;
    const float* const values = value_.data() + view * view_channels;
    const size_t first = size_t{kMiniKernels} * kMiniMixed * view;
    const uint16_t* channel = spec_->mixed_channel.data() + first;
    const float* weight = spec_->mixed_weight.data() + first;
    float* const now = series + newest_ * kMiniLanes;
    for (int k = 0; k < kMiniKernels;
         ++k, channel += kMiniMixed, weight += kMiniMixed) {
      float sum = 0;
      for (int m = 0; m < kMiniMixed && weight[m] != 0; ++m) {
        sum += weight[m] * values[channel[m]];
      }
      now[k] = sum;
    }
    for (int d = 0; d < kMiniDilationCount; ++d) {
      const float* taps[kMiniTaps];
      for (int tap = 0; tap < kMiniTaps; ++tap) {
        int at = newest_ + tap * kMiniDilations[d];
        if (at >= kMiniReach) at -= kMiniReach;
        taps[tap] = series + at * kMiniLanes;
      }
      const size_t row = size_t{kMiniDilationCount} * view + d;
      StepMiniKernels(taps,
                      threshold_.data() + row * kMiniThresholds * kMiniLanes,
                      kernel_values_.data() + row * kMiniLanes,
                      above_.data() + row * kMiniThresholds * kMiniLanes);
    }
  }
}

void TouchHistory::Write(std::span<float> numbers) const {
  if (frames_ == 0) {
    std::ranges::fill(numbers, 0.0F);
    return;
  }
  const double per_frame = 1 / static_cast<double>(frames_);
  float* out = numbers.data();
  for (size_t i = 0; i < channels_; ++i) {
    const double mean = sum_[i] * per_frame;
    out[i] = static_cast<float>(mean);
    out[channels_ + i] = static_cast<float>(
        std::sqrt(std::max(square_[i] * per_frame - mean * mean, 0.0)));
    out[4 * channels_ + i] = static_cast<float>(steps_[i] * per_frame);
    out[5 * channels_ + i] =
        static_cast<float>(static_cast<double>(active_[i]) * per_frame);
  }
  std::copy_n(largest_.data(), channels_, out + 2 * channels_);
  std::copy_n(smallest_.data(), channels_, out + 3 * channels_);
  std::copy_n(short_mean_.data(), channels_, out + 6 * channels_);
  std::copy_n(long_mean_.data(), channels_, out + 7 * channels_);
  WriteStretches(numbers.subspan(kHistoryStatistics * channels_,
                                 kHistoryStretches * channels_));
  out += (kHistoryStatistics + kHistoryStretches) * channels_;
  for (size_t row = 0; row < above_.size() / kMiniLanes; ++row) {
    for (int k = 0; k < kMiniKernels; ++k) {
      *out++ = static_cast<float>(above_[row * kMiniLanes + k] * per_frame);
    }
  }
}

void TouchHistory::WriteStretches(std::span<float> numbers) const {
  std::ranges::fill(numbers, 0.0F);
  const auto length = static_cast<double>(block_length_);
  const double stretch = static_cast<double>(frames_) / kHistoryStretches;
  for (int j = 0; j < kHistoryStretches; ++j) {
    const std::span<float> out = numbers.subspan(j * channels_, channels_);
    const double begin = j * stretch;
    const double end = begin + stretch;
    for (int b = 0; b < blocks_; ++b) {
      const double shared =
          std::min(end, (b + 1) * length) - std::max(begin, b * length);
      if (shared <= 0) continue;
      AddScaled(static_cast<float>(shared / stretch),
                block_mean_.data() + b * channels_, channels_, out.data());
    }
    // The block that is filled.
    const double shared = end - std::max(begin, blocks_ * length);
    if (block_frames_ == 0 || shared <= 0) continue;
    const double weight =
        shared / (stretch * static_cast<double>(block_frames_));
    for (size_t i = 0; i < channels_; ++i) {
      out[i] += static_cast<float>(weight * block_sum_[i]);
    }
  }
}

}  // namespace tactus::internal
