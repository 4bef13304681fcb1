#include "core/features/region_sum.h"

#include <algorithm>
#include <cstddef>

#include "core/features/light_touch_kernels.h"

namespace tactus {

RegionSum::RegionSum(const SkinLayout& layout, const Region& region)
    : rows_(layout.rows),
      columns_(layout.columns),
      wrap_(layout.wrap_columns),
      region_(region),
      padded_row_(region.left + columns_ + region.right),
      row_sums_(size_t(region.above + rows_ + region.below) * columns_) {}

float RegionSum::Run(std::span<const float> from, float scale,
                     std::span<float> sums) {
  float* const row_begin = padded_row_.data() + region_.left;
  float* const first_sums =
      row_sums_.data() + ptrdiff_t{region_.above} * columns_;
  for (int row = 0; row < rows_; ++row) {
    const float* const begin = from.data() + ptrdiff_t{row} * columns_;
    const float* const end = begin + columns_;
    std::copy(begin, end, row_begin);
    if (wrap_) {
      std::copy(end - region_.left, end, padded_row_.data());
      std::copy(begin, begin + region_.right, row_begin + columns_);
    }
    light_touch::SumAlong(padded_row_.data(), columns_, 1,
                          region_.left + 1 + region_.right, 1,
                          first_sums + ptrdiff_t{row} * columns_);
  }
  return light_touch::SumAlong(row_sums_.data(), sums.size(), columns_,
                               region_.above + 1 + region_.below, scale,
                               sums.data());
}

}  // namespace tactus
