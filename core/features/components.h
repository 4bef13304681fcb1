// File: components.h
//
// Segments one skin frame: threshold, binary image, connected components
// (paper, Section "Preprocessing and Feature Selection" of the robot
// experiment). Columns may wrap, dead taxels are masked out.
//
//   Segmenter segmenter(layout);
//   if (segmenter.Segment(frame.taxels) > 0) {
//     const Region& region = segmenter.largest();
//     ... region.max_value, region.taxels, region.centroid_row ...
//   }
//
// Owns its workspace: nothing is allocated per frame. Not thread-safe; one per
// stream.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/skin/layout.h"

namespace tactus {

// One connected component.
struct Region {
  int taxels = 0;
  // Largest value and sum of the values, in the layout's unit.
  float max_value = 0;
  double total = 0;
  // Mean row and column of the taxels, not weighted by their values. On a
  // skin that wraps, the column is counted along the region from its first
  // column on (from column 0 if it goes all the way round) and given modulo
  // `columns`, in [0, columns).
  double centroid_row = 0;
  double centroid_column = 0;
  // Smallest row-major index.
  int first_taxel = 0;
};

// `value` as taxels are compared with it: in float, so that a reading that was
// rounded to the threshold counts, and above 0, so that an empty taxel never
// does.
float TaxelThreshold(double value);

class Segmenter {
 public:
  // `layout` must be valid.
  explicit Segmenter(const SkinLayout& layout);

  // Finds the regions of taxels >= contact_threshold that are not masked out
  // and returns how many there are. `taxels` holds rows x columns values,
  // row-major; a NaN is not touched.
  int Segment(std::span<const float> taxels);

  // The results of the last Segment():

  // The region of most taxels; on a tie that of the larger max_value, then of
  // the smaller first_taxel. A zero Region if there is none.
  const Region& largest() const { return largest_; }

  // Largest value in any region; 0 if there is none.
  float peak() const { return peak_; }

  // Sums of the touched taxels in each row and in each column.
  std::span<const double> row_loads() const { return row_loads_; }
  std::span<const double> column_loads() const { return column_loads_; }

  // rows x columns, row-major: 0 is background, regions are numbered from 1 in
  // the order of their first taxels.
  std::span<const uint16_t> labels() const { return labels_; }

 private:
  // A maximal stretch of touched taxels in one row: columns begin .. end-1.
  struct Run {
    int row = 0;
    int begin = 0;
    int end = 0;
    // Index of an earlier run of the same region, or its own.
    int parent = 0;
    // Of the region; set once all rows are known.
    uint16_t label = 0;
    float max_value = 0;
    double total = 0;
  };

  struct Accumulator {
    Region region;
    int64_t row_sum = 0;
    int64_t column_sum = 0;
    // Bit c is set if the region has a taxel in column c.
    uint64_t columns = 0;
  };

  // Bit c is set if column c of the row is touched.
  uint64_t TouchedColumns(const float* row_taxels, int row) const;
  void AppendRuns(const float* row_taxels, int row, uint64_t touched);
  // Joins runs first .. end-1 of one row with each other across the seam and
  // with the runs previous .. first-1 of the row above.
  void JoinRow(int previous, int first, int end);
  void Join(int a, int b);
  int Root(int run);
  // Labels the taxels and sums over each region.
  void Accumulate();
  void ChooseLargest();
  // Fills in the centroid.
  void Locate(const Accumulator& sums, Region& region) const;

  int rows_;
  int columns_;
  bool wrap_;
  // How many columns apart two taxels in neighbouring rows may be: 1 if
  // 8-connected, else 0.
  int reach_;
  float threshold_;
  // One word a row: bit c is set if column c is valid.
  std::vector<uint64_t> valid_;

  std::vector<Run> runs_;
  std::vector<Accumulator> regions_;
  std::vector<uint16_t> labels_;
  std::vector<double> row_loads_;
  std::vector<double> column_loads_;
  Region largest_;
  float peak_ = 0;
};

}  // namespace tactus
