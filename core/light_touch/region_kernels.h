// File: region_kernels.h
//
// The loops over the regions of LightTouchFilter: their sums, and which taxels
// are felt. Each taxel's numbers are computed alike at any vector width, so all
// widths give the same bits.
//
//   const float largest = light_touch::SumAround(
//       {taxels, 16, 24, /*wrap=*/true}, 0, 16, /*scale=*/1.0F / 9, means);
//
// Compiled for several vector widths by Highway. Thread-safe: free functions
// without state. Nothing allocates.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/light_touch/light_touch_kernels.h"

namespace tactus::internal::light_touch {

// Writes sums[i] = scale (from[i] + from[i + stride] + ...) of `terms` terms
// for i < count. Returns the largest, or 0 if all are below.
float SumAlong(const float* from, size_t count, size_t stride, int terms,
               float scale, float* sums);

// Rows of `columns` numbers each, of which the last one may be a neighbour of
// the first. The numbers beside the first row and the last one can be read.
struct Grid {
  const float* from;
  int rows;
  int columns;
  bool wrap;
};

// Writes scale times the sum of the 3 x 3 numbers around each one of the rows
// begin .. end-1; those beyond the grid count as 0. `sums` has the grid's
// shape. Returns the largest, or 0 if all are below.
float SumAround(const Grid& grid, int begin, int end, float scale, float* sums);

// Returns the same without writing the sums.
float LargestAround(const Grid& grid, int begin, int end, float scale);

// A taxel is touched from when its region is at `begin` or its value at
// `strong`, and as long as its region is at `contact`. A taxel is felt if it is
// touched or its region is at `contact`.
struct Levels {
  float begin;
  float contact;
  float strong;
};

// A word per row of the skin: bit c is the taxel of column c, of at most 64.
struct Marks {
  // Written.
  uint64_t* felt;
  // Updated.
  uint64_t* touched;
};

// Marks the taxels of the rows begin .. end-1 by the sums of SumAround(), and
// returns the largest of these. Arrays have the grid's shape.
float MarkAround(const Grid& grid, int begin, int end, float scale,
                 const Readings& readings, const Levels& levels,
                 const Marks& marks);

// The same by sums that were written, of which grid.from has all.
void MarkSums(const Grid& sums, int begin, int end, const Readings& readings,
              const Levels& levels, const Marks& marks);

}  // namespace tactus::internal::light_touch
