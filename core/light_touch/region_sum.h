// File: region_sum.h
//
// RegionSum: for each taxel the sum over the region of taxels around it; first
// along the rows, then along the columns.
//
//   RegionSum sum(layout, {.above = 1, .below = 1, .left = 1, .right = 1});
//   const float largest =
//       sum.Run(taxels, /*scale=*/1.0F / 9, {.begin = 0, .end = 16}, means);
//
// Taxels beyond the skin's edges count as 0. Owns its workspace: Run()
// allocates nothing. Not thread-safe.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "core/base/aligned_vector.h"
#include "core/light_touch/region_kernels.h"
#include "core/skin/layout.h"

namespace tactus::internal {

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

  // The range that has, besides, `before` rows before it and `after` rows after
  // it, as far as there are so many; a skin has `rows`.
  RowRange Widened(size_t before, size_t after, size_t rows) const {
    if (empty()) return *this;
    return {begin - std::min(begin, before), std::min(end + after, rows)};
  }

  bool empty() const { return begin >= end; }
  size_t size() const { return end - begin; }
};

// One number for each taxel, with room beside them that kernels may read.
class SummedTaxels {
 public:
  explicit SummedTaxels(size_t taxels)
      : numbers_(kBeside + taxels + kBeside), taxels_(taxels) {}

  std::span<float> span() { return {numbers_.data() + kBeside, taxels_}; }
  std::span<const float> span() const {
    return {numbers_.data() + kBeside, taxels_};
  }

 private:
  // A cache line.
  static constexpr size_t kBeside = 16;

  AlignedVector<float> numbers_;
  size_t taxels_;
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
  // True for a region of 3 x 3 taxels, for which there are kernels that do not
  // need the sums of others (region_kernels.h).
  bool square() const { return square_; }
  // For kernels: `from` as in Run().
  light_touch::Grid GridOf(const float* from) const {
    return {from, rows_, columns_, wrap_};
  }

  // Writes scale times the sums of `from` around the taxels of `rows`. `from`
  // and `sums` have one number for each taxel of the skin. Returns the largest
  // sum, or 0 if all are below.
  float Run(const SummedTaxels& from, float scale, const RowRange& rows,
            std::span<float> sums);

 private:
  // Sum of the region's part in the taxel's own row.
  float SumAround(const float* row, int column) const;
  // Writes the sums along rows whose regions cross one of its ends.
  void SumAtEnds(const float* from, int rows, float* sums) const;

  int rows_;
  int columns_;
  bool wrap_;
  Region region_;
  // The usual region of 3 x 3 taxels is summed in one go.
  bool square_;
  // The sums along the rows, with rows of zeros above and below.
  AlignedVector<float> row_sums_;
};

}  // namespace tactus::internal
