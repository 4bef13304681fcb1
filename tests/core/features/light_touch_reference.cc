#include "tests/core/features/light_touch_reference.h"

#include <algorithm>
#include <cmath>

namespace tactus::internal {

LightTouchReference::LightTouchReference(const SkinLayout& layout,
                                         double sample_rate_hz)
    : layout_(layout),
      light_(*layout.light_touch),
      rate_(sample_rate_hz),
      smooth_(layout.taxels()),
      background_(layout.taxels()),
      values_(layout.taxels()),
      regions_(layout.taxels()),
      shape_(layout.taxels()),
      touched_(layout.taxels()) {}

void LightTouchReference::Step(std::span<const float> taxels) {
  ++frames_;
  const double plain = 1.0 / frames_;
  const auto fast = static_cast<float>(
      std::max(plain, -std::expm1(-1 / (light_.window_s * rate_))));
  const auto slow =
      static_cast<float>(std::max(plain, std::min(1.0, 1 / rate_)));
  const auto strong = static_cast<float>(layout_.contact_threshold);
  const auto contact = static_cast<float>(light_.contact_threshold);
  const auto onset = static_cast<float>(light_.onset_threshold);
  const bool ready = frames_ > std::max(1.0, std::ceil(0.3 * rate_ - 1e-9));
  std::vector<float> moved(taxels.size());
  std::vector<float> difference(taxels.size());
  for (size_t i = 0; i < taxels.size(); ++i) {
    const float x = taxels[i] + 1e-20F;
    smooth_[i] = smooth_[i] + fast * (x - smooth_[i]);
    moved[i] = background_[i] + slow * (x - background_[i]);
    if (!ready) continue;
    smooth_[i] = std::min(std::max(smooth_[i], x - strong), x + strong);
    if (!Valid(i)) continue;
    values_[i] = std::max(0.0F, x - background_[i]);
    difference[i] = smooth_[i] - background_[i];
  }
  if (!ready) {
    background_ = moved;
    return;
  }
  std::vector<char> felt(taxels.size());
  const float share = 1.0F / static_cast<float>(light_.rows * light_.columns);
  for (int row = 0; row < layout_.rows; ++row) {
    for (int column = 0; column < layout_.columns; ++column) {
      const int i = row * layout_.columns + column;
      regions_[i] = share * SumOfRegion(difference, row, column);
      const bool stays = regions_[i] >= contact;
      touched_[i] = regions_[i] >= onset || values_[i] >= strong ||
                    (touched_[i] != 0 && stays);
      felt[i] = touched_[i] != 0 || stays;
    }
  }
  const bool light = region_peak() >= contact && peak() < strong;
  light_frames_ = light ? light_frames_ + 1 : 0;
  has_shape_ = std::ranges::any_of(felt, [](char taxel) { return taxel != 0; });
  std::ranges::fill(shape_, 0.0F);
  std::vector<char> rests(taxels.size());
  for (int row = 0; row < layout_.rows; ++row) {
    for (int column = 0; column < layout_.columns; ++column) {
      const int i = row * layout_.columns + column;
      ForRegion(row, column, [&](int taxel) {
        if (felt[i] != 0) shape_[taxel] = difference[taxel];
        if (touched_[i] != 0 && !drifts()) rests[taxel] = 1;
      });
    }
  }
  for (size_t i = 0; i < taxels.size(); ++i) {
    if (rests[i] == 0) background_[i] = moved[i];
  }
}

float LightTouchReference::peak() const {
  return *std::ranges::max_element(values_);
}

float LightTouchReference::region_peak() const {
  return std::max(0.0F, *std::ranges::max_element(regions_));
}

float LightTouchReference::SumOfRow(const std::vector<float>& taxels, int row,
                                    int column) const {
  if (row < 0 || row >= layout_.rows) return 0;
  float sum = 0;
  for (int c = column - (light_.columns - 1) / 2;
       c <= column + light_.columns / 2; ++c) {
    const bool inside = c >= 0 && c < layout_.columns;
    if (!inside && !layout_.wrap_columns) continue;
    const int around = (c + layout_.columns) % layout_.columns;
    sum += taxels[row * layout_.columns + around];
  }
  return sum;
}

float LightTouchReference::SumOfRegion(const std::vector<float>& taxels,
                                       int row, int column) const {
  float sum = 0;
  for (int r = row - (light_.rows - 1) / 2; r <= row + light_.rows / 2; ++r) {
    sum += SumOfRow(taxels, r, column);
  }
  return sum;
}

template <typename Use>
void LightTouchReference::ForRegion(int row, int column, const Use& use) const {
  for (int r = row - (light_.rows - 1) / 2; r <= row + light_.rows / 2; ++r) {
    if (r < 0 || r >= layout_.rows) continue;
    for (int c = column - (light_.columns - 1) / 2;
         c <= column + light_.columns / 2; ++c) {
      const bool inside = c >= 0 && c < layout_.columns;
      if (!inside && !layout_.wrap_columns) continue;
      use(r * layout_.columns + (c + layout_.columns) % layout_.columns);
    }
  }
}

bool LightTouchReference::Valid(size_t taxel) const {
  return layout_.mask.empty() || layout_.mask[taxel] != 0;
}

}  // namespace tactus::internal
