// File: light_touch_kernels.h
//
// The loops over all taxels that LightTouchFilter consists of. Each taxel's
// numbers are computed alike at any vector width, so all widths give the same
// bits.
//
//   const float peak =
//       light_touch::StepMeans(taxels, 0.05F, 0.01F, 0.001F, 0.01F,
//       means).peak;
//
// Compiled for several vector widths by Highway. Thread-safe: free functions
// without state. Nothing allocates.
#pragma once

#include <cstddef>
#include <span>

namespace tactus::light_touch {

// Arrays with one number per taxel.
struct Means {
  // 1 for a valid taxel, 0 for one to ignore.
  const float* valid;
  const float* background;
  // Changed.
  float* smooth;
  // Written: max(0, taxel - background) and smooth - background of valid
  // taxels, else 0.
  float* values;
  float* difference;
};

// Moves each mean towards its taxel by `weight`.
void MoveTowards(std::span<const float> taxels, float weight, float* means);

// The numbers that reach some level are all among begin .. end-1; both are 0 if
// there are none.
struct Stretch {
  size_t begin = 0;
  size_t end = 0;
};

// The largest of `values`, and where `difference` and `values` reach a level.
struct Felt {
  float peak = 0;
  Stretch differences;
  Stretch values;
};

// Moves `smooth` likewise, but leaves it no further than `reach` from the
// taxel. `difference` and `value` are the levels of the result.
Felt StepMeans(std::span<const float> taxels, float weight, float reach,
               float difference, float value, const Means& means);

// The largest of some numbers, or 0 if all are below, and where they reach a
// level.
struct Sums {
  float peak = 0;
  Stretch loud;
};

// Writes sums[i] = scale (from[i] + from[i + stride] + ...) of `terms` terms
// for i < count. `level` is the level of the result.
Sums SumAlong(const float* from, size_t count, size_t stride, int terms,
              float scale, float level, float* sums);

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

// Moves each background towards its taxel by `weight`, unless the sum of marks
// around the taxel is at `resting`. Writes the shape: the difference of taxels
// with marks around them, else 0.
void Learn(std::span<const float> taxels, const float* mark_sums,
           const float* difference, float weight, float resting,
           float* background, float* shape);

}  // namespace tactus::light_touch
