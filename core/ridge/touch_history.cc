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

int TouchHistory::parts() const {
  return kHistoryStatistics + kHistoryStretches +
         (spec_->has_kernels() ? kFrameViews : 0);
}

size_t TouchHistory::LargestPart() const {
  return std::max(channels_, spec_->threshold.size() / kFrameViews);
}

size_t TouchHistory::WritePart(int part, std::span<float> numbers) const {
  const int view = part - kHistoryStatistics - kHistoryStretches;
  const std::span<float> out = numbers.first(
      view < 0 ? channels_ : spec_->threshold.size() / kFrameViews);
  if (frames_ == 0) {
    std::ranges::fill(out, 0.0F);
  } else if (part < kHistoryStatistics) {
    WriteStatistic(part, out);
  } else if (view < 0) {
    stretches_.WriteStretch(part - kHistoryStatistics, out);
  } else {
    WriteKernels(view, out);
  }
  return out.size();
}

void TouchHistory::Write(std::span<float> numbers) const {
  for (int part = 0; part < parts(); ++part) {
    numbers = numbers.subspan(WritePart(part, numbers));
  }
}

void TouchHistory::WriteStatistic(int statistic,
                                  std::span<float> numbers) const {
  const double per_frame = 1 / static_cast<double>(frames_);
  const auto write = [&](const auto& number_of) {
    for (size_t i = 0; i < numbers.size(); ++i) {
      numbers[i] = static_cast<float>(number_of(i));
    }
  };
  switch (statistic) {
    case 0:
      return write([&](size_t i) { return sum_[i] * per_frame; });
    case 1:
      return write([&](size_t i) {
        const double mean = sum_[i] * per_frame;
        return std::sqrt(std::max(square_[i] * per_frame - mean * mean, 0.0));
      });
    case 2:
      return write([&](size_t i) { return largest_[i]; });
    case 3:
      return write([&](size_t i) { return smallest_[i]; });
    case 4:
      return write([&](size_t i) { return steps_[i] * per_frame; });
    case 5:
      return write([&](size_t i) {
        return static_cast<double>(active_[i]) * per_frame;
      });
    case 6:
      return write([&](size_t i) { return short_mean_[i]; });
    default:
      return write([&](size_t i) { return long_mean_[i]; });
  }
}

void TouchHistory::WriteKernels(int view, std::span<float> numbers) const {
  const double per_frame = 1 / static_cast<double>(frames_);
  const size_t rows = numbers.size() / kMiniKernels;
  float* out = numbers.data();
  for (size_t row = view * rows; row < (view + 1) * rows; ++row) {
    for (int k = 0; k < kMiniKernels; ++k) {
      *out++ = static_cast<float>(above_[row * kMiniLanes + k] * per_frame);
    }
  }
}

}  // namespace tactus::internal
