// File: flat_layout.h
//
// A flat skin for tests: taxels of 10 x 10 mm, contact and onset at 1.
#pragma once

#include "core/skin/layout.h"

namespace tactus::testing {

inline SkinLayout FlatLayout(int rows, int columns) {
  SkinLayout layout;
  layout.rows = rows;
  layout.columns = columns;
  layout.row_pitch_m = 0.01;
  layout.column_pitch_m = 0.01;
  layout.taxel_area_m2 = 1e-4;
  layout.contact_threshold = 1;
  layout.onset_threshold = 1;
  return layout;
}

}  // namespace tactus::testing
