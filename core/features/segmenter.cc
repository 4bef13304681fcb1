#include "core/features/segmenter.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>

namespace tactus::internal {
namespace {

// The most regions that FindLargest finds.
constexpr size_t kMaxFound = 32;

// Bits begin .. end-1; 0 <= begin < end <= 64.
uint64_t BitRange(int begin, int end) {
  return (~uint64_t{0} >> (64 - (end - begin))) << begin;
}

}  // namespace

float TaxelThreshold(double value) {
  using Limits = std::numeric_limits<float>;
  return static_cast<float>(
      std::clamp<double>(value, Limits::denorm_min(), Limits::max()));
}

Segmenter::Segmenter(const SkinLayout& layout, bool skip_untouched)
    : rows_(layout.rows),
      columns_(layout.columns),
      wrap_(layout.wrap_columns),
      reach_(layout.connectivity == Connectivity::kEight ? 1 : 0),
      threshold_(TaxelThreshold(layout.contact_threshold)),
      skip_untouched_(skip_untouched),
      valid_(TouchedWords(layout.taxels()), ~uint64_t{0}),
      touched_(valid_.size() + 1),
      row_columns_(rows_) {
  for (size_t i = 0; i < layout.mask.size(); ++i) {
    if (layout.mask[i] == 0) valid_[i / 64] &= ~(uint64_t{1} << (i % 64));
  }
  runs_.reserve(rows_ * ((columns_ + 1) / 2));
}

void Segmenter::Clear() {
  runs_.clear();
  largest_ = Region();
  peak_ = 0;
  regions_ = 0;
}

int Segmenter::Segment(std::span<const float> shape, float threshold,
                       std::span<const float> values) {
  Clear();
  const bool touched = FindRows(shape, threshold);
  if (!touched && skip_untouched_) return 0;
  TouchedSum sum = SumTouched(values, touched_);
  peak_ = sum.max_value;
  if (touched && LocateBlob()) {
    regions_ = 1;
  } else {
    largest_root_ = FindRegions(values);
    if (regions_ > 1) sum = SumRegion(values, largest_root_);
    if (regions_ > 0) Locate(largest_root_, largest_);
  }
  largest_.max_value = sum.max_value;
  largest_.total = sum.total;
  return regions_;
}

bool Segmenter::FindRows(std::span<const float> shape, float threshold) {
  if (!FindTouched(shape, threshold, touched_) && skip_untouched_) {
    return false;
  }
  for (size_t i = 0; i < valid_.size(); ++i) touched_[i] &= valid_[i];
  const uint64_t all = BitRange(0, columns_);
  // Bit r is set if row r is touched.
  uint64_t rows = 0;
  for (int row = 0; row < rows_; ++row) {
    const int bit = row * columns_;
    const uint64_t* word = &touched_[bit / 64];
    const int shift = bit % 64;
    // Two shifts, as one by 64 means nothing.
    row_columns_[row] = (word[0] >> shift | word[1] << 1 << (63 - shift)) & all;
    rows |= uint64_t{row_columns_[row] != 0} << row;
  }
  first_row_ = std::countr_zero(rows);
  end_row_ = std::bit_width(rows);
  return rows != 0;
}

bool Segmenter::LocateBlob() {
  uint64_t columns = 0;
  for (int row = first_row_; row < end_row_; ++row) {
    columns |= row_columns_[row];
  }
  // Turned so that a blob across the seam is in one piece.
  const int turn = Crosses(columns) ? std::countr_one(columns) : 0;
  const uint64_t all = BitRange(0, columns_);
  int taxels = 0;
  int64_t row_sum = 0;
  // Twice the sum.
  int64_t column_sum = 0;
  uint64_t reached = all;
  for (int row = first_row_; row < end_row_; ++row) {
    uint64_t run = row_columns_[row];
    if (turn > 0) run = (run >> turn | run << (columns_ - turn)) & all;
    // Its lowest bit carries past the end of its first stretch.
    const uint64_t past = run + (run & -run);
    if ((run & reached) == 0 || (run & past) != 0) return false;
    reached = reach_ == 0 ? run : run | run << 1 | run >> 1;
    const int begin = std::countr_zero(run);
    const int end = std::countr_zero(past);
    taxels += end - begin;
    row_sum += int64_t{row} * (end - begin);
    column_sum += int64_t{2 * turn + begin + end - 1} * (end - begin);
  }
  largest_.taxels = taxels;
  largest_.first_taxel =
      first_row_ * columns_ + std::countr_zero(row_columns_[first_row_]);
  largest_.centroid_row = static_cast<double>(row_sum) / taxels;
  largest_.centroid_column = CentroidColumn(column_sum / 2, taxels);
  return true;
}

bool Segmenter::Crosses(uint64_t columns) const {
  return wrap_ && columns != BitRange(0, columns_) && (columns & 1) != 0 &&
         (columns >> (columns_ - 1)) != 0;
}

double Segmenter::CentroidColumn(int64_t column_sum, int taxels) const {
  const int64_t round = int64_t{columns_} * taxels;
  if (column_sum >= round) column_sum -= round;
  return static_cast<double>(column_sum) / taxels;
}

int Segmenter::FindRegions(std::span<const float> taxels) {
  int previous = 0;
  for (int row = first_row_; row < end_row_; ++row) {
    const int first = static_cast<int>(runs_.size());
    AppendRuns(row, row_columns_[row]);
    JoinRow(previous, first, static_cast<int>(runs_.size()));
    previous = first;
  }
  return MeasureRegions(taxels);
}

void Segmenter::AppendRuns(int row, uint64_t touched) {
  while (touched != 0) {
    const int begin = std::countr_zero(touched);
    const int end = begin + std::countr_one(touched >> begin);
    runs_.push_back({.row = row,
                     .begin = begin,
                     .end = end,
                     .parent = static_cast<int>(runs_.size())});
    touched &= ~BitRange(begin, end);
  }
}

void Segmenter::JoinRow(int previous, int first, int end) {
  // Both rows are sorted by column: of two runs the one that ends first can
  // touch nothing further on.
  for (int above = previous, here = first; above < first && here < end;) {
    const Run& a = runs_[above];
    const Run& b = runs_[here];
    if (a.begin < b.end + reach_ && b.begin < a.end + reach_) Join(above, here);
    if (a.end < b.end) {
      ++above;
    } else {
      ++here;
    }
  }
  if (!wrap_ || first == end) return;
  const auto opens = [this](int run) { return runs_[run].begin == 0; };
  const auto closes = [this](int run) { return runs_[run].end == columns_; };
  if (opens(first) && closes(end - 1)) Join(first, end - 1);
  if (reach_ == 0 || previous == first) return;
  if (opens(previous) && closes(end - 1)) Join(previous, end - 1);
  if (opens(first) && closes(first - 1)) Join(first - 1, first);
}

// The earliest run of a region is its root, so labels follow raster order.
void Segmenter::Join(int a, int b) {
  const auto [low, high] = std::minmax({Root(a), Root(b)});
  runs_[high].parent = low;
}

int Segmenter::Root(int run) {
  while (runs_[run].parent != run) {
    runs_[run].parent = runs_[runs_[run].parent].parent;
    run = runs_[run].parent;
  }
  return run;
}

int Segmenter::MeasureRegions(std::span<const float> taxels) {
  for (int i = 0; i < static_cast<int>(runs_.size()); ++i) {
    Run& run = runs_[i];
    // Its parent comes earlier and knows its first run by now.
    run.parent = runs_[run.parent].parent;
    Run& root = runs_[run.parent];
    if (run.parent == i) {
      ++regions_;
    } else {
      runs_[root.last].next = i;
    }
    root.last = i;
    root.taxels += run.end - run.begin;
  }
  int best = 0;
  if (regions_ == 1) return best;
  // Below 0: not known yet.
  float best_peak = -1;
  for (int i = 1; i < static_cast<int>(runs_.size()); ++i) {
    const int taxels_here = runs_[i].taxels;
    const int most = runs_[best].taxels;
    if (taxels_here < most) continue;
    float peak = -1;
    if (taxels_here == most) {
      if (best_peak < 0) best_peak = SumRegion(taxels, best).max_value;
      peak = SumRegion(taxels, i).max_value;
      if (!(peak > best_peak)) continue;
    }
    best = i;
    best_peak = peak;
  }
  return best;
}

TouchedSum Segmenter::SumRegion(std::span<const float> taxels, int root) const {
  TouchedAdder sum;
  for (int i = root; i != kNoRun; i = runs_[i].next) {
    const size_t first = ptrdiff_t{runs_[i].row} * columns_;
    sum.Add(taxels, first + runs_[i].begin, first + runs_[i].end);
  }
  return sum.Sum();
}

void Segmenter::Locate(int root, Region& region) const {
  uint64_t columns = 0;
  for (int i = root; i != kNoRun; i = runs_[i].next) {
    columns |= BitRange(runs_[i].begin, runs_[i].end);
  }
  // Across the seam its columns form one arc of the cylinder: those of its
  // end, next to column 0, are counted beyond the last one.
  const int tail = Crosses(columns) ? std::countr_one(columns) : 0;
  int64_t row_sum = 0;
  int64_t column_sum = 0;
  for (int i = root; i != kNoRun; i = runs_[i].next) {
    const Run& run = runs_[i];
    const int length = run.end - run.begin;
    row_sum += int64_t{run.row} * length;
    column_sum += int64_t{run.begin + run.end - 1} * length / 2;
    if (run.begin < tail) column_sum += int64_t{columns_} * length;
  }
  const Run& first = runs_[root];
  region.taxels = first.taxels;
  region.first_taxel = first.row * columns_ + first.begin;
  region.centroid_row = static_cast<double>(row_sum) / first.taxels;
  region.centroid_column = CentroidColumn(column_sum, first.taxels);
}

int Segmenter::FindLargest(std::span<const float> values,
                           std::span<RegionPlace> regions) {
  if (regions_ == 0 || regions.empty()) return 0;
  if (regions_ == 1) {
    regions[0].region = largest_;
    regions[0].rows.Clear();
    for (int row = first_row_; row < end_row_; ++row) {
      regions[0].rows.Add(row, row_columns_[row]);
    }
    return 1;
  }
  // The roots of the largest so far, by falling size.
  std::array<int, kMaxFound> roots;
  const size_t room = std::min(regions.size(), roots.size());
  size_t found = 0;
  for (int i = 0; i < static_cast<int>(runs_.size()); ++i) {
    if (runs_[i].parent != i) continue;
    size_t place = found;
    while (place > 0 && runs_[roots[place - 1]].taxels < runs_[i].taxels) {
      --place;
    }
    if (place == room) continue;
    if (found < room) ++found;
    std::copy_backward(roots.begin() + place, roots.begin() + found - 1,
                       roots.begin() + found);
    roots[place] = i;
  }
  for (size_t i = 0; i < found; ++i) {
    CopyRegion(roots[i], regions[i].rows);
    if (roots[i] == largest_root_) {
      regions[i].region = largest_;
      continue;
    }
    Locate(roots[i], regions[i].region);
    const TouchedSum sum = SumRegion(values, roots[i]);
    regions[i].region.max_value = sum.max_value;
    regions[i].region.total = sum.total;
  }
  return static_cast<int>(found);
}

void Segmenter::CopyRegion(int root, TaxelRows& rows) const {
  rows.Clear();
  for (int i = root; i != kNoRun; i = runs_[i].next) {
    rows.Add(runs_[i].row, BitRange(runs_[i].begin, runs_[i].end));
  }
}

std::span<const uint64_t> Segmenter::LargestRows() {
  if (regions_ <= 1) return row_columns_;
  CopyRegion(largest_root_, largest_rows_);
  return largest_rows_.words().first(rows_);
}

void Segmenter::SumLoads(std::span<const float> values,
                         std::span<const uint64_t> rows,
                         std::span<double> row_loads,
                         std::span<double> column_loads) const {
  std::fill(row_loads.begin(), row_loads.end(), 0.0);
  std::fill(column_loads.begin(), column_loads.end(), 0.0);
  if (regions_ == 0) return;
  for (int row = first_row_; row < end_row_; ++row) {
    const float* in_row = &values[ptrdiff_t{row} * columns_];
    for (uint64_t rest = rows[row]; rest != 0; rest &= rest - 1) {
      const int column = std::countr_zero(rest);
      row_loads[row] += in_row[column];
      column_loads[column] += in_row[column];
    }
  }
}

LoadSpread Segmenter::Spread(std::span<const float> values,
                             std::span<const uint64_t> rows,
                             const Region& region) const {
  double load = 0;
  double row_sum = 0;
  double row_squares = 0;
  double column_sum = 0;
  double column_squares = 0;
  for (int row = first_row_; regions_ > 0 && row < end_row_; ++row) {
    const int first = row * columns_;
    for (uint64_t rest = rows[row]; rest != 0; rest &= rest - 1) {
      const int place = std::countr_zero(rest);
      const double value = std::max(values[first + place], 0.0F);
      // From the centroid, the short way round.
      double column = place - region.centroid_column;
      if (wrap_) column -= columns_ * std::round(column / columns_);
      const double away = row - region.centroid_row;
      load += value;
      row_sum += value * away;
      row_squares += value * away * away;
      column_sum += value * column;
      column_squares += value * column * column;
    }
  }
  if (!(load > 0)) return {};
  const auto variance = [load](double squares, double sum) {
    const double mean = sum / load;
    return static_cast<float>(std::max(squares / load - mean * mean, 0.0));
  };
  return {.rows = variance(row_squares, row_sum),
          .columns = variance(column_squares, column_sum)};
}

void Segmenter::CopyLoads(std::span<const float> values,
                          std::span<const uint64_t> rows,
                          std::vector<TaxelLoad>& loads) const {
  loads.clear();
  if (regions_ == 0) return;
  for (int row = first_row_; row < end_row_; ++row) {
    const int first = row * columns_;
    for (uint64_t rest = rows[row]; rest != 0; rest &= rest - 1) {
      const int taxel = first + std::countr_zero(rest);
      // A taxel of a region of light touch may read nothing at once.
      const float load = std::max(values[taxel], 0.0F);
      loads.push_back({static_cast<uint32_t>(taxel), std::sqrt(load)});
    }
  }
}

void Segmenter::CopyLabels(std::span<uint16_t> labels) const {
  std::fill(labels.begin(), labels.end(), 0);
  if (regions_ == 1) {
    for (size_t i = 0; i < labels.size(); ++i) {
      labels[i] = touched_[i / 64] >> (i % 64) & 1;
    }
    return;
  }
  uint16_t last = 0;
  for (const Run& run : runs_) {
    const Run& root = runs_[run.parent];
    const bool is_first = &root == &run;
    if (is_first) ++last;
    const int first_taxel = run.row * columns_ + run.begin;
    const uint16_t label =
        is_first ? last : labels[root.row * columns_ + root.begin];
    std::fill_n(labels.begin() + first_taxel, run.end - run.begin, label);
  }
}

}  // namespace tactus::internal
