// File: segmenter.h
//
// Segments one skin frame: threshold, binary image, connected components
// (paper, Section "Preprocessing and Feature Selection" of the robot
// experiment). Columns may wrap, dead taxels are masked out.
//
//   Segmenter segmenter(layout);
//   if (segmenter.Segment(frame.taxels) > 0) {
//     const Region& region = segmenter.largest();
//     Use(region.max_value, region.taxels, region.centroid_row);
//   }
//
// Owns its workspace: nothing is allocated per frame. Not thread-safe; one per
// stream.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/features/feature.h"
#include "core/features/taxel_rows.h"
#include "core/features/touched.h"
#include "core/skin/layout.h"

namespace tactus::internal {

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

// A region and its taxels.
struct RegionPlace {
  Region region;
  TaxelRows rows = {};
};

// Returns `value` as taxels are compared with it: as a float, so that a reading
// that was rounded to the threshold counts, and above 0, so that a taxel of 0
// never counts.
float TaxelThreshold(double value);

class Segmenter {
 public:
  // `layout` must be valid. With `skip_untouched`, a frame without a touched
  // taxel costs one scan; the results are the same.
  explicit Segmenter(const SkinLayout& layout, bool skip_untouched = true);

  // Finds the regions of taxels >= contact_threshold that are not masked out
  // and returns how many there are. `taxels` holds rows x columns values,
  // row-major; a NaN is not touched.
  int Segment(std::span<const float> taxels) {
    return Segment(taxels, threshold_, taxels);
  }

  // The same with another threshold, above 0, and with values that differ from
  // the `shape` that is compared with it: those of the regions' taxels, at
  // least 0.
  int Segment(std::span<const float> shape, float threshold,
              std::span<const float> values);

  // Forgets the last frame: the results are those of an untouched one.
  void Clear();

  // The results of the last Segment():

  // The region with the most taxels. Ties go to the larger max_value, then to
  // the smaller first_taxel. A zero Region if there is none.
  const Region& largest() const { return largest_; }

  // The largest region, one word per row as rows(). Valid until the next
  // Segment().
  std::span<const uint64_t> LargestRows();

  // Largest value in any region; 0 if there is none.
  float peak() const { return peak_; }

  // How many regions there are.
  int regions() const { return regions_; }

  // The touched taxels, one word per row: bit c of word r is set if the taxel
  // in row r and column c is touched. Of no meaning without a region.
  std::span<const uint64_t> rows() const { return row_columns_; }

  // Fills `regions` with the largest regions, as many as it has room for, by
  // falling size; ties go to the smaller first_taxel. Returns how many, at most
  // 32.
  // `values` are those last segmented.
  int FindLargest(std::span<const float> values,
                  std::span<RegionPlace> regions);

  // Writes the sums of the taxels of `rows` in each row and in each column.
  // `rows` are touched, one word per row as rows(); `values` are those last
  // segmented.
  void SumLoads(std::span<const float> values, std::span<const uint64_t> rows,
                std::span<double> row_loads,
                std::span<double> column_loads) const;

  // Mean squared distances of the load of `rows`, a region or a part of one,
  // from its middle, in squared rows and columns; zero without load. The middle
  // lies near `region`. `values` and `rows` as for SumLoads.
  LoadSpread Spread(std::span<const float> values,
                    std::span<const uint64_t> rows, const Region& region) const;

  // Writes the taxels of `rows` to `loads`, by rising index; `values` and
  // `rows` as for SumLoads. Reuses the memory of `loads`.
  void CopyLoads(std::span<const float> values, std::span<const uint64_t> rows,
                 std::vector<TaxelLoad>& loads) const;

  // Writes rows x columns labels, row-major: 0 is background, regions are
  // numbered from 1 in the order of their first taxels.
  void CopyLabels(std::span<uint16_t> labels) const;

 private:
  static constexpr int kNoRun = -1;

  // A maximal stretch of touched taxels in one row: columns begin .. end-1.
  struct Run {
    int row = 0;
    int begin = 0;
    int end = 0;
    // Index of an earlier run of the same region, or its own; once all rows
    // are known, of the region's first run.
    int parent = 0;
    // Taxels of the region and the index of its last run, in its first run.
    int taxels = 0;
    int last = 0;
    // Index of the region's next run.
    int next = kNoRun;
  };

  // Finds the touched taxels, row by row. Returns false if there are none; then
  // the rows are unchanged if they may be skipped.
  bool FindRows(std::span<const float> shape, float threshold);
  // Most contacts are one region with one run in each of its rows. Returns
  // whether this frame is such a contact, and if so finds its place.
  bool LocateBlob();
  // Finds the regions of any other frame. Returns the first run of the largest.
  int FindRegions(std::span<const float> taxels);
  void AppendRuns(int row, uint64_t touched);
  // Joins runs first .. end-1 of one row with each other across the seam and
  // with the runs previous .. first-1 of the row above.
  void JoinRow(int previous, int first, int end);
  void Join(int a, int b);
  int Root(int run);
  // Finds each run's region and its size. Returns the first run of the
  // largest.
  int MeasureRegions(std::span<const float> taxels);
  // Largest value and sum of the region of a root.
  TouchedSum SumRegion(std::span<const float> taxels, int root) const;
  void CopyRegion(int root, TaxelRows& rows) const;
  // Finds the place of the region of a root; its loads stay as they are.
  void Locate(int root, Region& region) const;
  // True if a region with taxels in `columns` crosses the seam.
  bool Crosses(uint64_t columns) const;
  // Returns the mean column of a region from the sum of its columns, counted
  // along the region.
  double CentroidColumn(int64_t column_sum, int taxels) const;

  int rows_;
  int columns_;
  bool wrap_;
  // How many columns apart two taxels in neighbouring rows may be: 1 if
  // 8-connected, else 0.
  int reach_;
  float threshold_;
  bool skip_untouched_;
  // One bit per taxel, row-major: valid taxels; touched taxels, and one word
  // more.
  std::vector<uint64_t> valid_;
  std::vector<uint64_t> touched_;
  // One word per row: bit c is set if column c is touched. Rows before
  // first_row_ and from end_row_ on are untouched.
  std::vector<uint64_t> row_columns_;
  // The same of the largest region, once it was asked for.
  TaxelRows largest_rows_;
  int first_row_ = 0;
  int end_row_ = 0;
  // Empty if the frame is one blob.
  std::vector<Run> runs_;
  // The first run of the largest region.
  int largest_root_ = 0;
  int regions_ = 0;
  Region largest_;
  float peak_ = 0;
};

}  // namespace tactus::internal
