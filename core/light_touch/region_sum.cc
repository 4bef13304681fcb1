#include "core/light_touch/region_sum.h"

#include <algorithm>
#include <cstddef>

#include "core/light_touch/light_touch_kernels.h"

namespace tactus {

RegionSum::RegionSum(const SkinLayout& layout, const Region& region)
    : rows_(layout.rows),
      columns_(layout.columns),
      wrap_(layout.wrap_columns),
      region_(region),
      row_sums_(size_t(region.above + rows_ + region.below) * columns_) {}

RegionSum::Found RegionSum::Run(std::span<const float> from, float scale,
                                const RowRange& rows, float level,
                                std::span<float> sums) {
  if (rows.empty()) return {};
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
  light_touch::SumAlong(&from[first], count - beside, 1, beside + 1, 1, level,
                        row_sums + first + region_.left);
  for (int row = begin; row < end; ++row) {
    const ptrdiff_t at = ptrdiff_t{row} * columns_;
    SumAtEnds(&from[at], row_sums + at);
  }
  const auto columns = static_cast<size_t>(columns_);
  const size_t at = rows.begin * columns;
  const light_touch::Sums found = light_touch::SumAlong(
      row_sums_.data() + at, rows.size() * columns, columns,
      region_.above + 1 + region_.below, scale, level, &sums[at]);
  RowRange loud = RowRange::Of(found.loud.begin, found.loud.end, columns);
  if (!loud.empty()) loud = {rows.begin + loud.begin, rows.begin + loud.end};
  return {found.peak, loud};
}

void RegionSum::SumAtEnds(const float* row, float* sums) const {
  if (region_.left == 1 && region_.right == 1) {
    // The usual case. Adds in the same order as SumAround().
    const int last = columns_ - 1;
    sums[0] = (wrap_ ? row[last] + row[0] : row[0]) + row[1];
    const float inside = row[last - 1] + row[last];
    sums[last] = wrap_ ? inside + row[0] : inside;
    return;
  }
  const int beside = region_.left + region_.right;
  for (int i = 0; i < beside; ++i) {
    const int column = i < region_.left ? i : columns_ - beside + i;
    sums[column] = SumAround(row, column);
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

}  // namespace tactus
