#include "core/light_touch/light_touch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/light_touch/light_touch_kernels.h"

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
                                   double sample_rate_hz, bool skip_quiet_rows)
    : taxels_(layout.taxels()),
      rows_(layout.rows),
      columns_(layout.columns),
      skip_quiet_rows_(skip_quiet_rows),
      light_(*layout.light_touch),
      contact_threshold_(static_cast<float>(layout.contact_threshold)),
      window_weight_(-std::expm1(-1 / (light_.window_s * sample_rate_hz))),
      background_weight_(std::min(1.0, 1 / (kBackground * sample_rate_hz))),
      first_frames_(WholeFrames(kFirstBackground, sample_rate_hz)),
      drift_frames_(WholeFrames(kDrift, sample_rate_hz)),
      valid_(layout.mask.size(), 1),
      smooth_(taxels_),
      background_(taxels_),
      moved_(taxels_),
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
  summed_ = {};
  marked_ = {};
  shaped_ = {};
  quiet_rows_ = 0;
  for (AlignedVector<float>* const each :
       {&smooth_, &background_, &values_, &regions_, &shape_}) {
    std::ranges::fill(*each, 0.0F);
  }
  std::ranges::fill(marks_.span(), 0.0F);
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
  FindMarks(StepMeans(taxels, window, background));
  const bool light =
      region_peak_ >= static_cast<float>(light_.contact_threshold) &&
      peak_ < contact_threshold_;
  light_frames_ = light ? std::min(light_frames_ + 1, drift_frames_ + 1) : 0;
  Learn(light_frames_ > drift_frames_ ? std::numeric_limits<float>::infinity()
                                      : light_touch::kTouchedMark);
}

RowRange LightTouchFilter::StepMeans(std::span<const float> taxels,
                                     float weight, float background_weight) {
  const light_touch::Felt felt = light_touch::StepMeans(
      taxels, weight, contact_threshold_, background_weight,
      {.valid = valid_.empty() ? nullptr : valid_.data(),
       .background = background_.data(),
       .smooth = smooth_.data(),
       .moved = moved_.data(),
       .values = values_.data(),
       .difference = difference_.span().data()});
  peak_ = felt.value;
  const RowRange all = {0, rows_};
  // A region's mean is rounded by less than the tenth part of this.
  constexpr float kRounding = 1e-4F;
  const auto contact = static_cast<float>(light_.contact_threshold);
  const RowRange summed =
      skip_quiet_rows_ ? Around(RowsAt(difference_.span(), felt.difference,
                                       contact * (1 - kRounding)),
                                region_sum_.region())
                       : all;
  Clear(summed_, summed, regions_);
  summed_ = summed;
  quiet_rows_ = static_cast<int>(rows_ - summed.size());
  region_peak_ = region_sum_.Run(
      difference_, 1.0F / static_cast<float>(light_.rows * light_.columns),
      summed, regions_);
  if (!skip_quiet_rows_) return all;
  return RowRange::Join(RowsAt(regions_, region_peak_, contact),
                        RowsAt(values_, peak_, contact_threshold_));
}

void LightTouchFilter::FindMarks(const RowRange& rows) {
  Clear(marked_, rows, marks_.span());
  marked_ = rows;
  RowRange shaped;
  if (!rows.empty()) {
    const float mark = light_touch::Mark(
        Part(std::span(regions_), rows), Part(std::span(values_), rows).data(),
        {.begin = static_cast<float>(light_.onset_threshold),
         .contact = static_cast<float>(light_.contact_threshold),
         .strong = contact_threshold_},
        Part(marks_.span(), rows).data());
    if (mark > 0) shaped = Around(rows, mark_sum_.region());
  }
  Clear(shaped_, shaped, shape_);
  shaped_ = shaped;
}

void LightTouchFilter::Learn(float resting) {
  // Nothing is marked around the other rows.
  if (!shaped_.empty()) {
    mark_sum_.Run(marks_, 1, shaped_, mark_sums_);
    light_touch::Learn(Part(std::span(background_), shaped_),
                       Part(std::span(mark_sums_), shaped_).data(),
                       Part(difference_.span(), shaped_).data(), resting,
                       Part(std::span(moved_), shaped_).data(),
                       Part(std::span(shape_), shaped_).data());
  }
  background_.swap(moved_);
}

RowRange LightTouchFilter::RowsAt(std::span<const float> numbers, float largest,
                                  float level) const {
  if (!(largest >= level)) return {};
  const light_touch::Stretch found = light_touch::FindReached(numbers, level);
  return RowRange::Of(found.begin, found.end, columns_);
}

RowRange LightTouchFilter::Around(const RowRange& rows,
                                  const RegionSum::Region& region) const {
  if (rows.empty()) return rows;
  const auto above = static_cast<size_t>(region.above);
  const auto below = static_cast<size_t>(region.below);
  return {rows.begin - std::min(rows.begin, below),
          std::min(rows.end + above, rows_)};
}

void LightTouchFilter::Clear(const RowRange& was, const RowRange& now,
                             std::span<float> taxels) const {
  const RowRange before = {was.begin, std::min(was.end, now.begin)};
  const RowRange after = {std::max(was.begin, now.end), was.end};
  if (now.empty()) {
    std::ranges::fill(Part(taxels, was), 0.0F);
    return;
  }
  if (!before.empty()) std::ranges::fill(Part(taxels, before), 0.0F);
  if (!after.empty()) std::ranges::fill(Part(taxels, after), 0.0F);
}

}  // namespace tactus
