// File: pareto.h
//
// Which points no other point beats on both axes.
//
//   auto front = ParetoFront(points, Better::kLow, Better::kHigh);
//
// Thread-safe: a free function without state.
#pragma once

#include <vector>

#include "tools/figures/scatter_plot.h"

namespace tactus::internal::client {

// Indices of the points for which no other is at least as good on both axes
// and better on one; by increasing x, of equal points the first.
std::vector<int> ParetoFront(const std::vector<ScatterPoint>& points,
                             Better better_x, Better better_y);

}  // namespace tactus::internal::client
