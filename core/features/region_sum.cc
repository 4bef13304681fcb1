#include "core/features/region_sum.h"

#include <cstddef>

#include "core/features/light_touch_kernels.h"

namespace tactus {

RegionSum::RegionSum(const SkinLayout& layout, const Region& region)
    : rows_(layout.rows),
      columns_(layout.columns),
      wrap_(layout.wrap_columns),
      region_(region),
      row_sums_(size_t(region.above + rows_ + region.below) * columns_) {}

float RegionSum::Run(std::span<const float> from, float scale,
                     std::span<float> sums) {
  float* const row_sums =
      row_sums_.data() + ptrdiff_t{region_.above} * columns_;
  const int beside = region_.left + region_.right;
  // All rows in one go, as if they followed each other; then the taxels whose
  // regions cross an end of their row, once more.
  light_touch::SumAlong(from.data(), from.size() - beside, 1, beside + 1, 1,
                        row_sums + region_.left);
  for (int row = 0; row < rows_; ++row) {
    const ptrdiff_t begin = ptrdiff_t{row} * columns_;
    for (int i = 0; i < beside; ++i) {
      const int column = i < region_.left ? i : columns_ - beside + i;
      row_sums[begin + column] = SumAround(&from[begin], column);
    }
  }
  return light_touch::SumAlong(row_sums_.data(), sums.size(), columns_,
                               region_.above + 1 + region_.below, scale,
                               sums.data());
}

float RegionSum::SumAround(const float* row, int column) const {
  float sum = 0;
  for (int c = column - region_.left; c <= column + region_.right; ++c) {
    if (c >= 0 && c < columns_) {
      sum += row[c];
    } else if (wrap_) {
      sum += row[c < 0 ? c + columns_ : c - columns_];
    }
  }
  return sum;
}

}  // namespace tactus
