#include "core/features/light_touch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/features/light_touch_kernels.h"

namespace tactus {
namespace {

constexpr double kBackground = 1;         // s
constexpr double kFirstBackground = 0.3;  // s
constexpr double kDrift = 10;             // s

uint64_t WholeFrames(double seconds, double sample_rate_hz) {
  return static_cast<uint64_t>(
      std::max(1.0, std::ceil(seconds * sample_rate_hz * (1 - 1e-12))));
}

}  // namespace

LightTouchFilter::LightTouchFilter(const SkinLayout& layout,
                                   double sample_rate_hz)
    : taxels_(layout.taxels()),
      light_(*layout.light_touch),
      contact_threshold_(static_cast<float>(layout.contact_threshold)),
      window_weight_(-std::expm1(-1 / (light_.window_s * sample_rate_hz))),
      background_weight_(std::min(1.0, 1 / (kBackground * sample_rate_hz))),
      first_frames_(WholeFrames(kFirstBackground, sample_rate_hz)),
      drift_frames_(WholeFrames(kDrift, sample_rate_hz)),
      valid_(taxels_, 1),
      smooth_(taxels_),
      background_(taxels_),
      values_(taxels_),
      difference_(taxels_),
      regions_(taxels_),
      marks_(taxels_),
      mark_sums_(taxels_),
      shape_(taxels_),
      region_sum_(layout, {.above = (light_.rows - 1) / 2,
                           .below = light_.rows / 2,
                           .left = (light_.columns - 1) / 2,
                           .right = light_.columns / 2}),
      mark_sum_(layout, {.above = light_.rows / 2,
                         .below = (light_.rows - 1) / 2,
                         .left = light_.columns / 2,
                         .right = (light_.columns - 1) / 2}) {
  for (size_t i = 0; i < layout.mask.size(); ++i) {
    valid_[i] = layout.mask[i] != 0 ? 1.0F : 0.0F;
  }
}

void LightTouchFilter::Reset() {
  frames_ = 0;
  light_frames_ = 0;
  peak_ = 0;
  region_peak_ = 0;
  marked_ = false;
  for (AlignedVector<float>* const each :
       {&smooth_, &background_, &values_, &regions_, &marks_, &mark_sums_,
        &shape_}) {
    std::ranges::fill(*each, 0.0F);
  }
}

void LightTouchFilter::Step(std::span<const float> taxels) {
  // No more is needed, and the count never overflows.
  frames_ = std::min(frames_ + 1, uint64_t{1} << 32);
  const double plain = 1 / static_cast<double>(frames_);
  const auto window = static_cast<float>(std::max(plain, window_weight_));
  const auto background =
      static_cast<float>(std::max(plain, background_weight_));
  if (!ready()) {
    light_touch::MoveTowards(taxels, window, smooth_.data());
    light_touch::MoveTowards(taxels, background, background_.data());
    return;
  }
  peak_ = light_touch::StepMeans(taxels, window, contact_threshold_,
                                 {.valid = valid_.data(),
                                  .background = background_.data(),
                                  .smooth = smooth_.data(),
                                  .values = values_.data(),
                                  .difference = difference_.data()});
  region_peak_ = region_sum_.Run(
      difference_, 1.0F / static_cast<float>(light_.rows * light_.columns),
      regions_);
  const auto contact = static_cast<float>(light_.contact_threshold);
  const bool light = region_peak_ >= contact && peak_ < contact_threshold_;
  light_frames_ = light ? std::min(light_frames_ + 1, drift_frames_ + 1) : 0;
  // Else nothing is marked, and nothing was.
  float mark = 0;
  if (marked_ || region_peak_ >= contact || peak_ >= contact_threshold_) {
    mark =
        light_touch::Mark(regions_, values_.data(),
                          {.begin = static_cast<float>(light_.onset_threshold),
                           .contact = contact,
                           .strong = contact_threshold_},
                          marks_.data());
  }
  if (mark > 0) {
    mark_sum_.Run(marks_, 1, mark_sums_);
  } else if (marked_) {
    std::ranges::fill(mark_sums_, 0.0F);
  }
  marked_ = mark > 0;
  const float resting = light_frames_ > drift_frames_
                            ? std::numeric_limits<float>::infinity()
                            : light_touch::kTouchedMark;
  light_touch::Learn(taxels, mark_sums_.data(), difference_.data(), background,
                     resting, background_.data(), shape_.data());
}

}  // namespace tactus
