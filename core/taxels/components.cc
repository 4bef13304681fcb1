#include "core/taxels/components.h"

#include <bit>
#include <cmath>

namespace tactus::internal {
namespace {

// 2 with values below 0, else 1.
int Signs(const SkinLayout& layout) { return layout.signed_values ? 2 : 1; }

// False if the axis is the load of a taxel.
bool HasPlanes(const SkinLayout& layout, int axis) {
  if (layout.axes == 1 && !layout.signed_values) return false;
  return layout.normal_axis != axis;
}

class Adder {
 public:
  Adder(std::span<const float> values, std::vector<TaxelLoad>& loads)
      : values_(values), loads_(loads) {}

  // What of a value is above 0, or with `below` what is below it.
  void Add(uint32_t component, size_t value, bool below) {
    const float part = below ? -values_[value] : values_[value];
    if (part > 0) loads_.push_back({component, std::sqrt(part)});
  }

 private:
  const std::span<const float> values_;
  std::vector<TaxelLoad>& loads_;
};

}  // namespace

TaxelShape ShapeOf(const SkinLayout& layout) {
  TaxelShape shape = {.rows = layout.rows, .columns = layout.columns};
  for (int axis = 0; axis < layout.axes; ++axis) {
    if (HasPlanes(layout, axis)) shape.planes += Signs(layout);
  }
  shape.auxiliary =
      static_cast<int>(layout.auxiliary.size()) * layout.axes * Signs(layout);
  return shape;
}

TaxelShape WithoutComponents(const TaxelShape& shape) {
  return {.rows = shape.rows, .columns = shape.columns};
}

void AddComponents(const SkinLayout& layout, std::span<const float> values,
                   std::span<const uint64_t> rows,
                   std::vector<TaxelLoad>& loads) {
  Adder adder(values, loads);
  auto first = static_cast<uint32_t>(layout.taxels());
  for (int axis = 0; axis < layout.axes; ++axis) {
    if (!HasPlanes(layout, axis)) continue;
    for (int sign = 0; sign < Signs(layout); ++sign) {
      for (int row = 0; row < layout.rows; ++row) {
        for (uint64_t rest = rows[row]; rest != 0; rest &= rest - 1) {
          const auto taxel = static_cast<uint32_t>(row * layout.columns +
                                                   std::countr_zero(rest));
          adder.Add(first + taxel, size_t{taxel} * layout.axes + axis,
                    sign == 1);
        }
      }
      first += static_cast<uint32_t>(layout.taxels());
    }
  }
  for (const uint32_t taxel : layout.auxiliary) {
    for (int axis = 0; axis < layout.axes; ++axis) {
      for (int sign = 0; sign < Signs(layout); ++sign) {
        adder.Add(first++, size_t{taxel} * layout.axes + axis, sign == 1);
      }
    }
  }
}

std::span<const TaxelLoad> WithoutComponents(std::span<const TaxelLoad> loads,
                                             int taxels) {
  while (!loads.empty() &&
         loads.back().taxel >= static_cast<uint32_t>(taxels)) {
    loads = loads.first(loads.size() - 1);
  }
  return loads;
}

}  // namespace tactus::internal
