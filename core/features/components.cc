#include "core/features/components.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <limits>

#include "core/features/touched.h"

namespace tactus {
namespace {

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

Segmenter::Segmenter(const SkinLayout& layout)
    : rows_(layout.rows),
      columns_(layout.columns),
      wrap_(layout.wrap_columns),
      reach_(layout.connectivity == Connectivity::kEight ? 1 : 0),
      threshold_(TaxelThreshold(layout.contact_threshold)),
      valid_(rows_, BitRange(0, columns_)),
      touched_(TouchedWords(layout.taxels()) + 1) {
  for (size_t i = 0; i < layout.mask.size(); ++i) {
    if (layout.mask[i] != 0) continue;
    valid_[i / columns_] &= ~(uint64_t{1} << (i % columns_));
  }
  runs_.reserve(rows_ * ((columns_ + 1) / 2));
}

int Segmenter::Segment(std::span<const float> taxels) {
  runs_.clear();
  largest_ = Region();
  peak_ = 0;
  regions_ = 0;
  if (!FindTouched(taxels, threshold_, touched_)) return 0;
  int previous = 0;
  for (int row = 0; row < rows_; ++row) {
    const int first = static_cast<int>(runs_.size());
    AppendRuns(row, TouchedColumns(row));
    JoinRow(previous, first, static_cast<int>(runs_.size()));
    previous = first;
  }
  if (runs_.empty()) return 0;
  MeasureLargest(taxels.data(), MeasureRegions(taxels.data()));
  return regions_;
}

uint64_t Segmenter::TouchedColumns(int row) const {
  const int bit = row * columns_;
  const uint64_t* word = &touched_[bit / 64];
  const int shift = bit % 64;
  // Two shifts, as one by 64 means nothing.
  const uint64_t touched = word[0] >> shift | word[1] << 1 << (63 - shift);
  return touched & valid_[row];
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

int Segmenter::MeasureRegions(const float* taxels) {
  int best = 0;
  for (int i = 0; i < static_cast<int>(runs_.size()); ++i) {
    Run& run = runs_[i];
    // Its parent comes earlier and knows its first run by now.
    run.parent = runs_[run.parent].parent;
    regions_ += run.parent == i;
    float max_value = 0;
    const float* row = taxels + ptrdiff_t{run.row} * columns_;
    for (int column = run.begin; column < run.end; ++column) {
      max_value = std::max(max_value, row[column]);
    }
    Run& root = runs_[run.parent];
    root.taxels += run.end - run.begin;
    root.max_value = std::max(root.max_value, max_value);
    peak_ = std::max(peak_, max_value);
  }
  if (regions_ == 1) return 0;
  for (int i = 1; i < static_cast<int>(runs_.size()); ++i) {
    const Run& run = runs_[i];
    const Run& most = runs_[best];
    if (run.taxels > most.taxels ||
        (run.taxels == most.taxels && run.max_value > most.max_value)) {
      best = i;
    }
  }
  return best;
}

void Segmenter::MeasureLargest(const float* taxels, int root) {
  int64_t row_sum = 0;
  int64_t column_sum = 0;
  uint64_t columns = 0;
  for (const Run& run : runs_) {
    if (run.parent != root) continue;
    const float* row = taxels + ptrdiff_t{run.row} * columns_;
    double total = 0;
    for (int column = run.begin; column < run.end; ++column) {
      total += row[column];
    }
    const int length = run.end - run.begin;
    largest_.total += total;
    row_sum += int64_t{run.row} * length;
    column_sum += int64_t{run.begin + run.end - 1} * length / 2;
    columns |= BitRange(run.begin, run.end);
  }
  const Run& first = runs_[root];
  largest_.taxels = first.taxels;
  largest_.max_value = first.max_value;
  largest_.first_taxel = first.row * columns_ + first.begin;
  column_sum = AlongRegion(column_sum, columns, root);
  largest_.centroid_row = static_cast<double>(row_sum) / first.taxels;
  largest_.centroid_column = static_cast<double>(column_sum) / first.taxels;
}

int64_t Segmenter::AlongRegion(int64_t column_sum, uint64_t columns,
                               int root) const {
  const bool crosses = wrap_ && columns != BitRange(0, columns_) &&
                       (columns & 1) != 0 && (columns >> (columns_ - 1)) != 0;
  if (!crosses) return column_sum;
  // Its columns form one arc of the cylinder: those of its end, next to column
  // 0, are counted beyond the last one.
  const int tail = std::countr_one(columns);
  int tail_taxels = 0;
  for (const Run& run : runs_) {
    if (run.parent == root && run.begin < tail) {
      tail_taxels += std::min(run.end, tail) - run.begin;
    }
  }
  const int64_t round = int64_t{columns_} * runs_[root].taxels;
  column_sum += int64_t{columns_} * tail_taxels;
  return column_sum >= round ? column_sum - round : column_sum;
}

void Segmenter::SumLoads(std::span<const float> taxels,
                         std::span<double> row_loads,
                         std::span<double> column_loads) const {
  std::fill(row_loads.begin(), row_loads.end(), 0.0);
  std::fill(column_loads.begin(), column_loads.end(), 0.0);
  for (const Run& run : runs_) {
    const float* row = &taxels[ptrdiff_t{run.row} * columns_];
    double total = 0;
    for (int column = run.begin; column < run.end; ++column) {
      total += row[column];
      column_loads[column] += row[column];
    }
    row_loads[run.row] += total;
  }
}

void Segmenter::CopyLabels(std::span<uint16_t> labels) const {
  std::fill(labels.begin(), labels.end(), 0);
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

}  // namespace tactus
