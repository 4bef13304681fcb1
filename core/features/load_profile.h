// File: load_profile.h
//
// Where the skin is loaded, in few numbers: square roots of the loads on bands
// of rows and on bands of columns. Of n rows band i of k has rows i n / k to
// (i + 1) n / k, less one; a skin of fewer rows than bands has one band a row,
// and bands of load 0 beyond. Columns likewise. Sums over the whole skin do
// not jump when a contact breaks into regions, and a root steadies the spread
// of a load that varies more the larger it is.
//
//   segmenter.Segment(frame.taxels);
//   segmenter.SumLoads(frame.taxels, row_loads, column_loads);
//   const LoadProfile profile = MakeLoadProfile(row_loads, column_loads);
//
// Thread-safe: a free function without state. Nothing allocates.
#pragma once

#include <span>

#include "core/features/feature.h"

namespace tactus {

// `row_loads` and `column_loads` hold one sum, at least 0, per row and column.
LoadProfile MakeLoadProfile(std::span<const double> row_loads,
                            std::span<const double> column_loads);

}  // namespace tactus
