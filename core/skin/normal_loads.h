// File: normal_loads.h
//
// NormalLoads: makes one load per taxel from a frame of any axes, and the shear
// of a set of taxels. All that looks for contacts looks at loads.
//
//   NormalLoads loads(layout);
//   for (const float load : loads.Of(frame.taxels)) Use(load);
//
// The load of a taxel is the value of the normal axis, or 0 if that is below 0;
// without a normal axis it is the Euclidean distance of its values from those
// of the untouched skin, which are 0. On a skin of one axis without signed
// values, the loads are the values themselves.
//
// Owns room for one frame; nothing else allocates. Not thread-safe: one per
// stream.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/skin/layout.h"

namespace tactus::internal {

// What pulls along the skin: sums of the values of the two axes that are not
// the normal one, the lower axis first (without a normal axis x and y), in the
// layout's unit. Zero on a skin of one axis.
struct Shear {
  float first = 0;
  float second = 0;

  bool operator==(const Shear&) const = default;
};

class NormalLoads {
 public:
  // `layout` must be valid.
  explicit NormalLoads(const SkinLayout& layout);

  // `values`: one frame, layout.values() of them. Returns layout.taxels()
  // loads, none below 0, in the layout's unit; valid until the next call, and
  // no longer than `values`.
  std::span<const float> Of(std::span<const float> values);

 private:
  const int axes_;
  // Nothing: the distance from 0.
  const std::optional<int> normal_;
  // Empty if the values are the loads.
  std::vector<float> loads_;
};

// The shear of the taxels in `rows`, one word per row whose bit c is the taxel
// of column c. `values` are those of one frame.
Shear SumShear(const SkinLayout& layout, std::span<const float> values,
               std::span<const uint64_t> rows);

}  // namespace tactus::internal
