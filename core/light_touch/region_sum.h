// File: region_sum.h
//
// RegionSum: for each taxel the sum over the region of taxels around it; first
// along the rows, then along the columns.
//
//   RegionSum sum(layout, {.above = 1, .below = 1, .left = 1, .right = 1});
//   const RegionSum::Found found =
//       sum.Run(taxels, /*scale=*/1.0F / 9, {.begin = 0, .end = 16},
//               /*level=*/0.01F, means);
//
// Taxels beyond the skin's edges count as 0. Owns its workspace: Run()
// allocates nothing. Not thread-safe.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "core/base/aligned_vector.h"
#include "core/skin/layout.h"

namespace tactus {

// Rows begin .. end-1; none if both are 0.
struct RowRange {
  size_t begin = 0;
  size_t end = 0;

  // The rows of the taxels begin .. end-1.
  static RowRange Of(size_t begin, size_t end, size_t columns) {
    if (begin == end) return {};
    return {begin / columns, (end - 1) / columns + 1};
  }
  // The smallest range that has the rows of both.
  static RowRange Join(const RowRange& a, const RowRange& b) {
    if (a.empty()) return b;
    if (b.empty()) return a;
    return {std::min(a.begin, b.begin), std::max(a.end, b.end)};
  }

  bool empty() const { return begin >= end; }
  size_t size() const { return end - begin; }
};

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

  const Region& region() const { return region_; }

  // The largest sum, or 0 if all are below, and the rows that hold all sums at
  // some level.
  struct Found {
    float peak = 0;
    RowRange loud;
  };

  // Writes scale times the sums of `from` around the taxels of `rows`. `from`
  // and `sums` have one number for each taxel of the skin. `level` is the level
  // of the result.
  Found Run(std::span<const float> from, float scale, const RowRange& rows,
            float level, std::span<float> sums);

 private:
  // Sum of the region's part in the taxel's own row.
  float SumAround(const float* row, int column) const;
  // Writes the sums along a row whose regions cross one of its ends.
  void SumAtEnds(const float* row, float* sums) const;

  int rows_;
  int columns_;
  bool wrap_;
  Region region_;
  // The sums along the rows, with rows of zeros above and below.
  AlignedVector<float> row_sums_;
};

}  // namespace tactus
