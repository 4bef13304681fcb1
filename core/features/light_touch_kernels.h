// File: light_touch_kernels.h
//
// The loops over all taxels that LightTouchFilter consists of. Each taxel's
// numbers are computed alike at any vector width, so all widths give the same
// bits.
//
//   const float peak = light_touch::StepMeans(taxels, 0.05F, 0.01F, means);
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

// Moves `smooth` likewise, but leaves it no further than `reach` from the
// taxel. Returns the largest of `values`.
float StepMeans(std::span<const float> taxels, float weight, float reach,
                const Means& means);

// Writes sums[i] = scale (from[i] + from[i + stride] + ...) of `terms` terms
// for i < count. Returns the largest, or 0 if all are below.
float SumAlong(const float* from, size_t count, size_t stride, int terms,
               float scale, float* sums);

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
