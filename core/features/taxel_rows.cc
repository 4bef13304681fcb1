#include "core/features/taxel_rows.h"

#include <algorithm>
#include <bit>
#include <cstdlib>

namespace tactus::internal {

TaxelSets::TaxelSets(const SkinLayout& layout)
    : rows_(layout.rows),
      columns_(layout.columns),
      wrap_(layout.wrap_columns),
      all_(~uint64_t{0} >> (64 - layout.columns)) {}

int TaxelSets::Overlap(const TaxelRows& a, const TaxelRows& b) const {
  if ((a.columns_ & b.columns_) == 0) return 0;
  const int end = std::min(a.end_, b.end_);
  int count = 0;
  for (int row = std::max(a.first_, b.first_); row < end; ++row) {
    count += std::popcount(a.words_[row] & b.words_[row]);
  }
  return count;
}

bool TaxelSets::Overlaps(const TaxelRows& a, const TaxelRows& b) const {
  if ((a.columns_ & b.columns_) == 0) return false;
  const int end = std::min(a.end_, b.end_);
  uint64_t common = 0;
  for (int row = std::max(a.first_, b.first_); row < end; ++row) {
    common |= a.words_[row] & b.words_[row];
  }
  return common != 0;
}

int TaxelSets::Count(const TaxelRows& taxels) const {
  return Overlap(taxels, taxels);
}

void TaxelSets::Grow(TaxelRows& taxels) const {
  if (taxels.end_ == 0) return;
  taxels.first_ = std::max(taxels.first_ - 1, 0);
  taxels.end_ = std::min(taxels.end_ + 1, rows_);
  taxels.columns_ = Widen(taxels.columns_);
  uint64_t above = 0;
  for (int row = taxels.first_; row < taxels.end_; ++row) {
    const uint64_t here = taxels.words_[row];
    const uint64_t below = row + 1 < taxels.end_ ? taxels.words_[row + 1] : 0;
    taxels.words_[row] = Widen(above | here | below);
    above = here;
  }
}

void TaxelSets::Move(int rows, int columns, TaxelRows& taxels) const {
  TaxelRows moved;
  const int end = std::min(taxels.end_, rows_ - rows);
  for (int row = std::max(taxels.first_, -rows); row < end; ++row) {
    moved.Add(row + rows, Turn(taxels.words_[row], columns));
  }
  taxels = moved;
}

void TaxelSets::Add(const TaxelRows& more, TaxelRows& taxels) const {
  for (int row = more.first_; row < more.end_; ++row) {
    taxels.words_[row] |= more.words_[row];
  }
  taxels.first_ = std::min(taxels.first_, more.first_);
  taxels.end_ = std::max(taxels.end_, more.end_);
  taxels.columns_ |= more.columns_;
}

void TaxelSets::Remove(const TaxelRows& some, TaxelRows& taxels) const {
  for (int row = some.first_; row < some.end_; ++row) {
    taxels.words_[row] &= ~some.words_[row];
  }
}

uint64_t TaxelSets::Turn(uint64_t row, int columns) const {
  if (wrap_) columns = (columns % columns_ + columns_) % columns_;
  if (columns == 0) return row;
  if (std::abs(columns) >= columns_) return 0;
  if (columns < 0) return row >> -columns;
  const uint64_t moved = row << columns & all_;
  return wrap_ ? moved | row >> (columns_ - columns) : moved;
}

uint64_t TaxelSets::Widen(uint64_t row) const {
  const uint64_t wide = row | row << 1 | row >> 1;
  if (!wrap_) return wide & all_;
  return (wide | row << (columns_ - 1) | row >> (columns_ - 1)) & all_;
}

}  // namespace tactus::internal
