// File: load_profile.h
//
// Describes in few numbers where the skin is loaded: the square roots of the
// loads on bands of rows and on bands of columns. Band i of k bands has the
// rows from i n / k to (i + 1) n / k - 1 of n rows. A skin with fewer rows than
// bands has one band per row and further bands of load 0. Columns are treated
// alike. Sums over the whole skin do not jump when a contact breaks into
// regions. The square root makes the spread independent of the load, because
// larger loads vary more.
//
//   segmenter.Segment(frame.taxels);
//   segmenter.SumLoads(frame.taxels, segmenter.rows(), row_loads,
//                      column_loads);
//   const LoadProfile profile = MakeLoadProfile(row_loads, column_loads);
//
// Thread-safe: a free function without state. Nothing allocates.
#pragma once

#include <span>

#include "core/features/feature.h"

namespace tactus::internal {

// `row_loads` and `column_loads` hold one sum, at least 0, per row and column.
LoadProfile MakeLoadProfile(std::span<const double> row_loads,
                            std::span<const double> column_loads);

}  // namespace tactus::internal
