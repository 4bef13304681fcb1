// File: components.h
//
// Components: what a frame says beside the loads of its taxels. Learners that
// see all taxels take them as further taxels, which follow those of the skin.
//
//   AddComponents(layout, frame.taxels, touched_rows, loads);
//
// - Values of the axes that are not the load: shear on a skin whose normal axis
//   carries the load, all three axes of a magnetometer, the sign of the values
//   of one axis. They come in planes of one component per taxel: of each axis
//   that is not the normal one, what is above 0, and on skins of signed values
//   what is below 0. A plane has the touched taxels.
// - Values of auxiliary taxels (SkinLayout::auxiliary), taxel after taxel, each
//   as above, of all its axes, whether something touches the skin or not.
//
// A component is 0 or more; its root is stored, as those of loads are.
//
// Plain data and free functions without state; thread-safe.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/skin/layout.h"
#include "core/taxels/taxel_load.h"

namespace tactus::internal {

// How many taxels and components a frame has.
struct TaxelShape {
  int rows = 0;
  int columns = 0;
  // Planes of components.
  int planes = 0;
  // Components of auxiliary taxels.
  int auxiliary = 0;

  int taxels() const { return rows * columns; }
  // Taxels and components.
  int total() const { return taxels() * (1 + planes) + auxiliary; }

  bool operator==(const TaxelShape&) const = default;
};

TaxelShape ShapeOf(const SkinLayout& layout);

TaxelShape WithoutComponents(const TaxelShape& shape);

// Appends the components of a frame that are not 0, by rising index. `values`:
// those of all axes. `rows`: one word per row, whose bit c is the touched taxel
// of column c.
void AddComponents(const SkinLayout& layout, std::span<const float> values,
                   std::span<const uint64_t> rows,
                   std::vector<TaxelLoad>& loads);

// `loads` without components; `taxels` are those of the skin.
std::span<const TaxelLoad> WithoutComponents(std::span<const TaxelLoad> loads,
                                             int taxels);

}  // namespace tactus::internal
