// File: dent_kernels.h
//
// Measures the dent that a face presses into a skin (line_contact.h), strip by
// strip. Each strip's numbers are computed alike at any vector width, so all
// widths give the same bits.
//
//   dent_kernels::Cut({.depth = 0.001, .low = -0.02, .high = 0.02}, places,
//                     widths.data(), volumes.data(), areas.data());
//
// Compiled for several vector widths by Highway. Thread-safe: a free function
// without state. Nothing allocates.
#pragma once

#include <cstddef>
#include <span>

namespace tactus::internal::dent_kernels {

// Its depth at s across and y along the strips, m: depth + rise y -
// curvature s^2, where that is above 0 and s between low and high.
struct Dent {
  double depth = 0;
  double rise = 0;
  double curvature = 0;
  double low = 0;
  double high = 0;
};

// Arrays of strips have a length that is a multiple of this.
inline constexpr size_t kStrips = 8;

// Writes the dent's volume, m^3, and area, m^2, on each strip. `places` and
// `widths`, m, are those of the strips along y.
void Cut(const Dent& dent, std::span<const double> places, const double* widths,
         double* volumes, double* areas);

}  // namespace tactus::internal::dent_kernels
