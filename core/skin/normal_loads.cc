#include "core/skin/normal_loads.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

namespace tactus::internal {

NormalLoads::NormalLoads(const SkinLayout& layout)
    : axes_(layout.axes),
      normal_(layout.normal_axis),
      loads_(layout.axes > 1 || layout.signed_values ? layout.taxels() : 0) {}

std::span<const float> NormalLoads::Of(std::span<const float> values) {
  if (loads_.empty()) return values;
  const float* taxel = values.data();
  for (float& load : loads_) {
    if (normal_) {
      load = std::max(taxel[*normal_], 0.0F);
    } else {
      float squares = 0;
      for (int axis = 0; axis < axes_; ++axis) {
        squares += taxel[axis] * taxel[axis];
      }
      load = std::sqrt(squares);
    }
    taxel += axes_;
  }
  return loads_;
}

Shear SumShear(const SkinLayout& layout, std::span<const float> values,
               std::span<const uint64_t> rows) {
  if (layout.axes == 1) return {};
  const int normal = layout.normal_axis.value_or(2);
  const int first = normal == 0 ? 1 : 0;
  const int second = normal == 2 ? 1 : 2;
  double sums[2] = {0, 0};
  for (int row = 0; row < layout.rows; ++row) {
    for (uint64_t rest = rows[row]; rest != 0; rest &= rest - 1) {
      const size_t taxel = static_cast<size_t>(row) * layout.columns +
                           static_cast<size_t>(std::countr_zero(rest));
      sums[0] += values[taxel * layout.axes + first];
      sums[1] += values[taxel * layout.axes + second];
    }
  }
  return {static_cast<float>(sums[0]), static_cast<float>(sums[1])};
}

}  // namespace tactus::internal
