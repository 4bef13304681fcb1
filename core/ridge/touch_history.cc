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

constexpr size_t kKernelLanes =
    size_t{kFrameViews} * kMiniDilationCount * kMiniLanes;
constexpr size_t kViewSeries = size_t{kMiniReach} * kMiniLanes;

// Weight of the newest frame in a running mean over `window` frames: a plain
// mean until there are as many.
float MeanWeight(uint64_t frames, float window) {
  return 1 / std::min(static_cast<float>(frames), window);
}

}  // namespace

TouchHistory::TouchHistory(const HistorySpec* spec)
    : spec_(spec),
      channels_(static_cast<size_t>(spec->channels()) * kFrameViews),
      stretches_(channels_) {
  const size_t padded = PaddedChannels(channels_);
  for (auto* numbers : {&value_, &previous_, &largest_, &smallest_,
                        &short_mean_, &long_mean_}) {
    numbers->resize(padded);
  }
  for (auto* sums : {&sum_, &square_, &steps_}) {
    sums->resize(padded);
  }
  active_.resize(padded);
  if (spec->has_kernels()) {
    series_.resize(kViewSeries * kFrameViews);
    kernel_values_.resize(kKernelLanes);
    above_.resize(kKernelLanes * kMiniThresholds);
  }
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
  for (auto* sums : {&sum_, &square_, &steps_}) {
    std::ranges::fill(*sums, 0.0);
  }
  std::ranges::fill(largest_, std::numeric_limits<float>::lowest());
  std::ranges::fill(smallest_, std::numeric_limits<float>::max());
  std::ranges::fill(active_, 0U);
  std::ranges::fill(series_, 0.0F);
  std::ranges::fill(above_, 0U);
  stretches_.Reset();
  newest_ = 0;
}

void TouchHistory::Step(std::span<const TaxelLoad> loads) {
  previous_.swap(value_);
  ReadViews(*spec_, loads, std::span(value_).first(channels_));
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
               .block = stretches_.sums().data(),
               .short_weight = MeanWeight(frames_, kShortFrames),
               .long_weight = MeanWeight(frames_, kLongFrames)});
  stretches_.Step();
  if (spec_->has_kernels()) StepKernels();
}

void TouchHistory::StepKernels() {
  newest_ = newest_ == 0 ? kMiniReach - 1 : newest_ - 1;
  const size_t view_channels = channels_ / kFrameViews;
  for (int view = 0; view < kFrameViews; ++view) {
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
  stretches_.Write(numbers.subspan(kHistoryStatistics * channels_,
                                   kHistoryStretches * channels_));
  out += (kHistoryStatistics + kHistoryStretches) * channels_;
  for (size_t row = 0; row < above_.size() / kMiniLanes; ++row) {
    for (int k = 0; k < kMiniKernels; ++k) {
      *out++ = static_cast<float>(above_[row * kMiniLanes + k] * per_frame);
    }
  }
}

}  // namespace tactus::internal
