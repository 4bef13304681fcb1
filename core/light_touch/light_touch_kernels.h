// File: light_touch_kernels.h
//
// The loops over all taxels that LightTouchFilter consists of. Each taxel's
// numbers are computed alike at any vector width, so all widths give the same
// bits.
//
//   const float peak =
//       light_touch::StepMeans(taxels, 0.05F, 0.01F, 0.001F, means).value;
//
// Compiled for several vector widths by Highway. Thread-safe: free functions
// without state. Nothing allocates.
#pragma once

#include <cstddef>
#include <span>

namespace tactus::light_touch {

// Arrays with one number per taxel.
struct Means {
  // 1 for a valid taxel, 0 for one to ignore; null if all are valid.
  const float* valid;
  const float* background;
  // Changed.
  float* smooth;
  // Written: the background moved towards its taxel; max(0, taxel - background)
  // and smooth - background of valid taxels, else 0.
  float* moved;
  float* values;
  float* difference;
};

// Moves each mean towards its taxel by `weight`.
void MoveTowards(std::span<const float> taxels, float weight, float* means);

// The largest numbers that StepMeans() wrote, or 0 if all are below.
struct Felt {
  float value = 0;
  float difference = 0;
};

// Moves `smooth` likewise, but leaves it no further than `reach` from the
// taxel, and the background by `background_weight`.
Felt StepMeans(std::span<const float> taxels, float weight, float reach,
               float background_weight, const Means& means);

// The numbers that reach some level are all among begin .. end-1; both are 0 if
// there are none.
struct Stretch {
  size_t begin = 0;
  size_t end = 0;
};

// Looks from both ends, so that noise at the level is found at once.
Stretch FindReached(std::span<const float> numbers, float level);

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

// A taxel is touched from when its region is at `begin` or its value at
// `strong`, and as long as its region is at `contact`.
struct Levels {
  float begin;
  float contact;
  float strong;
};

// Marks of a taxel whose region is at `contact`, and of one that is touched. A
// region holds less of the former than one of the latter counts.
inline constexpr float kFeltMark = 1;
inline constexpr float kTouchedMark = 1024;

// Updates marks from regions and values. Returns the largest.
float Mark(std::span<const float> regions, const float* values,
           const Levels& levels, float* marks);

// Takes the moved background back to what it was where the sum of marks around
// the taxel is at `resting`. Writes the shape: the difference of taxels with
// marks around them, else 0.
void Learn(std::span<const float> background, const float* mark_sums,
           const float* difference, float resting, float* moved, float* shape);

}  // namespace tactus::light_touch
