// File: region_sum.h
//
// RegionSum: for each taxel the sum over the region of taxels around it; first
// along the rows, then along the columns.
//
//   RegionSum sum(layout, {.above = 1, .below = 1, .left = 1, .right = 1});
//   const float largest = sum.Run(taxels, /*scale=*/1.0F / 9, means);
//
// Taxels beyond the skin's edges count as 0. Owns its workspace: Run()
// allocates nothing. Not thread-safe.
#pragma once

#include <span>

#include "core/base/aligned_vector.h"
#include "core/skin/layout.h"

namespace tactus {

class RegionSum {
 public:
  // How many rows and columns a region has on each side of its taxel; at least
  // 0 and less than the skin has.
  struct Region {
    int above = 0;
    int below = 0;
    int left = 0;
    int right = 0;
  };

  RegionSum(const SkinLayout& layout, const Region& region);

  // Writes scale times the sums of `from`, one for each taxel. Returns the
  // largest, or 0 if all are below.
  float Run(std::span<const float> from, float scale, std::span<float> sums);

 private:
  // Sum of the region's part in the taxel's own row.
  float SumAround(const float* row, int column) const;

  int rows_;
  int columns_;
  bool wrap_;
  Region region_;
  // The sums along the rows, with rows of zeros above and below.
  AlignedVector<float> row_sums_;
};

}  // namespace tactus
