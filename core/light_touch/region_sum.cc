#include "core/light_touch/region_sum.h"

#include <algorithm>
#include <cstddef>

#include "core/light_touch/region_kernels.h"

namespace tactus::internal {

RegionSum::RegionSum(const SkinLayout& layout, const Region& region)
    : rows_(layout.rows),
      columns_(layout.columns),
      wrap_(layout.wrap_columns),
      region_(region),
      square_(region.above == 1 && region.below == 1 && region.left == 1 &&
              region.right == 1),
      row_sums_(size_t(region.above + rows_ + region.below) * columns_) {}

float RegionSum::Run(const SummedTaxels& taxels, float scale,
                     const RowRange& rows, std::span<float> sums) {
  if (rows.empty()) return 0;
  const std::span<const float> from = taxels.span();
  if (square_) {
    return light_touch::SumAround(
        {from.data(), rows_, columns_, wrap_}, static_cast<int>(rows.begin),
        static_cast<int>(rows.end), scale, sums.data());
  }
  float* const row_sums =
      row_sums_.data() + ptrdiff_t{region_.above} * columns_;
  const int beside = region_.left + region_.right;
  // The rows that the regions reach.
  const auto begin = std::max(static_cast<int>(rows.begin) - region_.above, 0);
  const auto end = std::min(static_cast<int>(rows.end) + region_.below, rows_);
  // All rows in one go, as if they followed each other; then the taxels whose
  // regions cross an end of their row, once more.
  const ptrdiff_t first = ptrdiff_t{begin} * columns_;
  const ptrdiff_t count = ptrdiff_t{end - begin} * columns_;
  light_touch::SumAlong(&from[first], count - beside, 1, beside + 1, 1,
                        row_sums + first + region_.left);
  SumAtEnds(&from[first], end - begin, row_sums + first);
  const auto columns = static_cast<size_t>(columns_);
  const size_t at = rows.begin * columns;
  return light_touch::SumAlong(row_sums_.data() + at, rows.size() * columns,
                               columns, region_.above + 1 + region_.below,
                               scale, &sums[at]);
}

void RegionSum::SumAtEnds(const float* from, int rows, float* sums) const {
  const int beside = region_.left + region_.right;
  for (int row = 0; row < rows; ++row) {
    const ptrdiff_t at = ptrdiff_t{row} * columns_;
    for (int i = 0; i < beside; ++i) {
      const int column = i < region_.left ? i : columns_ - beside + i;
      sums[at + column] = SumAround(from + at, column);
    }
  }
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

}  // namespace tactus::internal
