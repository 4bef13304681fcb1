#include "core/light_touch/light_touch.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace tactus::internal {
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
      share_(1.0F / static_cast<float>(light_.rows * light_.columns)),
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
      shape_(taxels_),
      felt_(rows_),
      touched_(rows_),
      near_felt_(rows_),
      near_touched_(rows_),
      region_sum_(layout, {.above = (light_.rows - 1) / 2,
                           .below = light_.rows / 2,
                           .left = (light_.columns - 1) / 2,
                           .right = light_.columns / 2}),
      holders_{.above = light_.rows / 2,
               .below = (light_.rows - 1) / 2,
               .left = light_.columns / 2,
               .right = (light_.columns - 1) / 2,
               .columns = layout.columns,
               .wrap = layout.wrap_columns} {
  for (size_t i = 0; i < layout.mask.size(); ++i) {
    valid_[i] = layout.mask[i] != 0 ? 1.0F : 0.0F;
  }
}

void LightTouchFilter::Reset() {
  frames_ = 0;
  light_frames_ = 0;
  peak_ = 0;
  region_peak_ = 0;
  marked_ = {};
  learned_ = {};
  has_shape_ = false;
  quiet_rows_ = 0;
  for (AlignedVector<float>* const each :
       {&smooth_, &background_, &values_, &regions_, &shape_}) {
    std::ranges::fill(*each, 0.0F);
  }
  felt_.Clear();
  touched_.Clear();
}

void LightTouchFilter::Step(std::span<const float> taxels) {
  // No more is needed, and the count never overflows.
  frames_ = std::min(frames_ + 1, uint64_t{1} << 32);
  const double plain = 1 / static_cast<double>(frames_);
  const auto window = static_cast<float>(std::max(plain, window_weight_));
  const auto background =
      static_cast<float>(std::max(plain, background_weight_));
  if (!ready()) {
    light_touch::MoveTowards(taxels, window, smooth_.data(), background,
                             background_.data());
    return;
  }
  const float* const valid = valid_.empty() ? nullptr : valid_.data();
  peak_ = light_touch::StepMeans(taxels, window, contact_threshold_, background,
                                 {.valid = valid,
                                  .background = background_.data(),
                                  .smooth = smooth_.data(),
                                  .moved = moved_.data(),
                                  .difference = difference_.span().data()});
  const light_touch::Readings readings = {.taxels = taxels.data(),
                                          .background = background_.data(),
                                          .valid = valid};
  const RowRange felt = Mark(readings);
  const bool light =
      region_peak_ >= static_cast<float>(light_.contact_threshold) &&
      peak_ < contact_threshold_;
  light_frames_ = light ? std::min(light_frames_ + 1, drift_frames_ + 1) : 0;
  Learn(readings, felt, /*rest=*/light_frames_ <= drift_frames_);
  background_.swap(moved_);
}

float LightTouchFilter::RegionPeak(std::span<const uint64_t> rows) {
  RowRange range = {0, rows_};
  while (range.begin < range.end && rows[range.begin] == 0) ++range.begin;
  while (range.begin < range.end && rows[range.end - 1] == 0) --range.end;
  // These are the sums that regions() has, if it has them.
  region_sum_.Run(difference_, share_, range, regions_);
  float peak = 0;
  for (size_t row = range.begin; row < range.end; ++row) {
    for (uint64_t rest = rows[row]; rest != 0; rest &= rest - 1) {
      peak = std::max(peak, regions_[row * columns_ + std::countr_zero(rest)]);
    }
  }
  return peak;
}

RowRange LightTouchFilter::LoudRows() const {
  // A region's mean is rounded by less than the tenth part of this.
  constexpr float kRounding = 1e-4F;
  const light_touch::Stretch loud = light_touch::FindReached(
      difference_.span(),
      static_cast<float>(light_.contact_threshold) * (1 - kRounding));
  return RowRange::Of(loud.begin, loud.end, columns_)
      .Widened(region_sum_.region().below, region_sum_.region().above, rows_);
}

RowRange LightTouchFilter::Mark(const light_touch::Readings& readings) {
  const light_touch::Levels levels = {
      .begin = static_cast<float>(light_.onset_threshold),
      .contact = static_cast<float>(light_.contact_threshold),
      .strong = contact_threshold_};
  const bool strong = peak_ >= levels.strong;
  RowRange rows = {0, rows_};
  if (skip_quiet_rows_ && !strong) rows = LoudRows();
  quiet_rows_ = static_cast<int>(rows_ - rows.size());
  if (rows.empty()) {
    region_peak_ = 0;
  } else if (skip_quiet_rows_ && region_sum_.square()) {
    MarkSquares(rows, readings, levels);
  } else {
    MarkRegions(rows, readings, levels);
  }
  RowRange felt;
  if (strong || region_peak_ >= levels.contact) {
    felt = rows;
    while (felt_.data()[felt.begin] == 0) ++felt.begin;
    while (felt_.data()[felt.end - 1] == 0) --felt.end;
  }
  ClearMarks(marked_, felt);
  marked_ = felt;
  return felt;
}

void LightTouchFilter::MarkSquares(const RowRange& rows,
                                   const light_touch::Readings& readings,
                                   const light_touch::Levels& levels) {
  const light_touch::Grid grid = region_sum_.GridOf(difference_.span().data());
  const auto begin = static_cast<int>(rows.begin);
  const auto end = static_cast<int>(rows.end);
  // A skin that felt something is likely to feel it still. Any other is likely
  // to feel nothing: then the largest mean says so, which costs less.
  if (marked_.empty() && !(peak_ >= levels.strong)) {
    region_peak_ = light_touch::LargestAround(grid, begin, end, share_);
    if (!(region_peak_ >= levels.contact)) return;
  }
  region_peak_ =
      light_touch::MarkAround(grid, begin, end, share_, readings, levels,
                              {felt_.data(), touched_.data()});
}

void LightTouchFilter::MarkRegions(const RowRange& rows,
                                   const light_touch::Readings& readings,
                                   const light_touch::Levels& levels) {
  region_peak_ = region_sum_.Run(difference_, share_, rows, regions_);
  if (!(peak_ >= levels.strong || region_peak_ >= levels.contact)) return;
  light_touch::MarkSums(region_sum_.GridOf(regions_.data()),
                        static_cast<int>(rows.begin),
                        static_cast<int>(rows.end), readings, levels,
                        {felt_.data(), touched_.data()});
}

void LightTouchFilter::ClearMarks(const RowRange& was, const RowRange& now) {
  for (size_t row = was.begin; row < was.end; ++row) {
    if (row >= now.begin && row < now.end) continue;
    felt_.data()[row] = touched_.data()[row] = 0;
  }
}

void LightTouchFilter::Learn(const light_touch::Readings& readings,
                             const RowRange& felt, bool rest) {
  has_shape_ = !felt.empty();
  if (skip_quiet_rows_ && felt.empty() && learned_.empty()) return;
  RowRange learned = felt.Widened(holders_.below, holders_.above, rows_);
  if (!skip_quiet_rows_) learned = {0, rows_};
  Clear(learned_, learned, values_);
  Clear(learned_, learned, shape_);
  learned_ = learned;
  if (learned.empty()) return;
  const auto find_near = [&](RowMarks& marks, RowMarks& near) {
    light_touch::FindNear(marks.data() + learned.begin, learned.size(),
                          holders_, near.data() + learned.begin);
  };
  find_near(felt_, near_felt_);
  if (rest) {
    find_near(touched_, near_touched_);
  } else {
    near_touched_.Clear();
  }
  light_touch::Learn({learned.size(), columns_},
                     readings.From(learned.begin * columns_),
                     {.felt = near_felt_.data() + learned.begin,
                      .touched = near_touched_.data() + learned.begin,
                      .difference = Part(difference_.span(), learned).data()},
                     Part(std::span(moved_), learned).data(),
                     Part(std::span(values_), learned).data(),
                     Part(std::span(shape_), learned).data());
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

}  // namespace tactus::internal
