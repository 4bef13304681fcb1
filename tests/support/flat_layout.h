// File: flat_layout.h
//
// Flat skins for tests: taxels of 10 x 10 mm.
//
//   const SkinLayout layout = testing::FlatLayout(16, 24);
//   const SkinLayout counts =
//       testing::FlatLayout("pad", 2, 2, TaxelUnit::kCounts, 10, 20);
#pragma once

#include <string>
#include <utility>

#include "core/skin/layout.h"

namespace tactus::internal::testing {

inline SkinLayout FlatLayout(std::string name, int rows, int columns,
                             TaxelUnit unit, double contact_threshold,
                             double onset_threshold) {
  SkinLayout layout;
  layout.name = std::move(name);
  layout.rows = rows;
  layout.columns = columns;
  layout.row_pitch_m = 0.01;
  layout.column_pitch_m = 0.01;
  layout.taxel_area_m2 = 1e-4;
  layout.unit = unit;
  layout.contact_threshold = contact_threshold;
  layout.onset_threshold = onset_threshold;
  return layout;
}

// In newton, without a name; contact and onset at 1.
inline SkinLayout FlatLayout(int rows, int columns) {
  return FlatLayout("", rows, columns, TaxelUnit::kNewton, 1, 1);
}

}  // namespace tactus::internal::testing
