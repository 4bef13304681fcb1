// File: light_touch_kernels.h
//
// The loops over all taxels that LightTouchFilter consists of. Each taxel's
// numbers are computed alike at any vector width, so all widths give the same
// bits.
//
//   const float peak =
//       light_touch::StepMeans(taxels, 0.05F, 0.01F, 0.001F, means);
//
// Compiled for several vector widths by Highway. Thread-safe: free functions
// without state. Nothing allocates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace tactus::internal::light_touch {

// Arrays with one number per taxel.
struct Means {
  // 1 for a valid taxel, 0 for one to ignore; null if all are valid.
  const float* valid;
  const float* background;
  // Changed.
  float* smooth;
  // Written: the background moved towards its taxel; smooth - background of
  // valid taxels, else 0.
  float* moved;
  float* difference;
};

// Moves each mean towards its taxel by its weight.
void MoveTowards(std::span<const float> taxels, float weight, float* smooth,
                 float background_weight, float* background);

// Moves `smooth` likewise, but leaves it no further than `reach` from the
// taxel, and the background by `background_weight`. Returns the largest value,
// which is taxel - background, of a valid taxel, or 0 if all are below.
float StepMeans(std::span<const float> taxels, float weight, float reach,
                float background_weight, const Means& means);

// The numbers that reach some level are all among begin .. end-1; both are 0 if
// there are none.
struct Stretch {
  size_t begin = 0;
  size_t end = 0;
};

// Looks from both ends, so that noise at the level is found at once.
Stretch FindReached(std::span<const float> numbers, float level);

// What values are computed from; arrays as in Means, of the same taxels.
struct Readings {
  const float* taxels;
  const float* background;
  const float* valid;

  // Those of the taxels from `first` on.
  Readings From(size_t first) const {
    return {taxels + first, background + first,
            valid == nullptr ? nullptr : valid + first};
  }
};

// Rows of at most 64 taxels each.
struct Rows {
  size_t rows;
  size_t columns;
};

// The taxels around a taxel, as in RegionSum, on a skin of at most 64 columns,
// of which the last one may be a neighbour of the first.
struct Surroundings {
  int above;
  int below;
  int left;
  int right;
  int columns;
  bool wrap;
};

// Marks in `near` the taxels around which one is marked. Bit c of word r is the
// taxel of row r and column c. The words before and after the skin's rows are 0
// in `marks` and may be written in `near`, as RowMarks has them.
void FindNear(const uint64_t* marks, size_t rows,
              const Surroundings& surroundings, uint64_t* near);

// Words of taxels near one that is felt, and near one that is touched; the
// difference of Means.
struct Near {
  const uint64_t* felt;
  const uint64_t* touched;
  const float* difference;
};

// Writes the values, at least 0, and the shape: the difference of taxels near
// one that is felt, else 0. Takes the moved background of those near one that
// is touched back to what it was.
void Learn(const Rows& rows, const Readings& readings, const Near& near,
           float* moved, float* values, float* shape);

}  // namespace tactus::internal::light_touch
