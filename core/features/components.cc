#include "core/features/components.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <limits>

namespace tactus {
namespace {

// Bits begin .. end-1; 0 <= begin < end <= 64.
uint64_t BitRange(int begin, int end) {
  return (~uint64_t{0} >> (64 - (end - begin))) << begin;
}

bool Larger(const Region& a, const Region& b) {
  if (a.taxels != b.taxels) return a.taxels > b.taxels;
  return a.max_value > b.max_value;
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
      labels_(layout.taxels()),
      row_loads_(rows_),
      column_loads_(columns_) {
  for (size_t i = 0; i < layout.mask.size(); ++i) {
    if (layout.mask[i] != 0) continue;
    valid_[i / columns_] &= ~(uint64_t{1} << (i % columns_));
  }
  const int max_runs = rows_ * ((columns_ + 1) / 2);
  runs_.reserve(max_runs);
  regions_.reserve(max_runs);
}

int Segmenter::Segment(std::span<const float> taxels) {
  runs_.clear();
  std::fill(row_loads_.begin(), row_loads_.end(), 0);
  std::fill(column_loads_.begin(), column_loads_.end(), 0);
  int previous = 0;
  for (int row = 0; row < rows_; ++row) {
    const int first = static_cast<int>(runs_.size());
    const float* row_taxels = taxels.data() + ptrdiff_t{row} * columns_;
    AppendRuns(row_taxels, row, TouchedColumns(row_taxels, row));
    JoinRow(previous, first, static_cast<int>(runs_.size()));
    previous = first;
  }
  Accumulate();
  ChooseLargest();
  return static_cast<int>(regions_.size());
}

uint64_t Segmenter::TouchedColumns(const float* row_taxels, int row) const {
  uint64_t touched = 0;
  for (int column = 0; column < columns_; ++column) {
    touched |= uint64_t{row_taxels[column] >= threshold_} << column;
  }
  return touched & valid_[row];
}

void Segmenter::AppendRuns(const float* row_taxels, int row, uint64_t touched) {
  while (touched != 0) {
    Run run;
    run.row = row;
    run.begin = std::countr_zero(touched);
    run.end = run.begin + std::countr_one(touched >> run.begin);
    run.parent = static_cast<int>(runs_.size());
    for (int column = run.begin; column < run.end; ++column) {
      run.max_value = std::max(run.max_value, row_taxels[column]);
      run.total += row_taxels[column];
      column_loads_[column] += row_taxels[column];
    }
    row_loads_[row] += run.total;
    touched &= ~BitRange(run.begin, run.end);
    runs_.push_back(run);
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

void Segmenter::Accumulate() {
  std::fill(labels_.begin(), labels_.end(), 0);
  regions_.clear();
  for (int i = 0; i < static_cast<int>(runs_.size()); ++i) {
    Run& run = runs_[i];
    const int first_taxel = run.row * columns_ + run.begin;
    const int root = Root(i);
    if (root == i) {
      regions_.emplace_back().region.first_taxel = first_taxel;
      run.label = static_cast<uint16_t>(regions_.size());
    } else {
      run.label = runs_[root].label;
    }
    const int length = run.end - run.begin;
    std::fill_n(labels_.begin() + first_taxel, length, run.label);
    Accumulator& sums = regions_[run.label - 1];
    sums.region.taxels += length;
    sums.region.max_value = std::max(sums.region.max_value, run.max_value);
    sums.region.total += run.total;
    sums.row_sum += int64_t{run.row} * length;
    sums.column_sum += int64_t{run.begin + run.end - 1} * length / 2;
    sums.columns |= BitRange(run.begin, run.end);
  }
}

void Segmenter::ChooseLargest() {
  largest_ = Region();
  peak_ = 0;
  const Accumulator* best = nullptr;
  for (const Accumulator& candidate : regions_) {
    peak_ = std::max(peak_, candidate.region.max_value);
    if (best == nullptr || Larger(candidate.region, best->region)) {
      best = &candidate;
    }
  }
  if (best == nullptr) return;
  largest_ = best->region;
  Locate(*best, largest_);
}

void Segmenter::Locate(const Accumulator& sums, Region& region) const {
  int64_t column_sum = sums.column_sum;
  const uint64_t all = BitRange(0, columns_);
  if (wrap_ && sums.columns != all && (sums.columns & 1) != 0 &&
      (sums.columns >> (columns_ - 1)) != 0) {
    // The region crosses the seam. Its columns form one arc of the cylinder:
    // those of its end, next to column 0, are counted beyond the last one.
    const int tail = std::countr_one(sums.columns);
    int tail_taxels = 0;
    for (const Run& run : runs_) {
      if (run.label == labels_[region.first_taxel] && run.begin < tail) {
        tail_taxels += std::min(run.end, tail) - run.begin;
      }
    }
    const int64_t round = int64_t{columns_} * region.taxels;
    column_sum += int64_t{columns_} * tail_taxels;
    if (column_sum >= round) column_sum -= round;
  }
  region.centroid_row = static_cast<double>(sums.row_sum) / region.taxels;
  region.centroid_column = static_cast<double>(column_sum) / region.taxels;
}

}  // namespace tactus
