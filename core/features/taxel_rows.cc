#include "core/features/taxel_rows.h"

#include <algorithm>
#include <bit>
#include <cstdlib>

namespace tactus {

TaxelSets::TaxelSets(const SkinLayout& layout)
    : rows_(layout.rows),
      columns_(layout.columns),
      wrap_(layout.wrap_columns),
      all_(~uint64_t{0} >> (64 - layout.columns)) {}

int TaxelSets::Overlap(const TaxelRows& a, const TaxelRows& b) const {
  int count = 0;
  for (int row = 0; row < rows_; ++row) count += std::popcount(a[row] & b[row]);
  return count;
}

bool TaxelSets::Overlaps(const TaxelRows& a, const TaxelRows& b) const {
  uint64_t common = 0;
  for (int row = 0; row < rows_; ++row) common |= a[row] & b[row];
  return common != 0;
}

int TaxelSets::Count(const TaxelRows& taxels) const {
  return Overlap(taxels, taxels);
}

void TaxelSets::Grow(TaxelRows& taxels) const {
  uint64_t above = 0;
  for (int row = 0; row < rows_; ++row) {
    const uint64_t here = taxels[row];
    const uint64_t below = row + 1 < rows_ ? taxels[row + 1] : 0;
    const uint64_t column = above | here | below;
    taxels[row] = column | Turn(column, 1) | Turn(column, -1);
    above = here;
  }
}

void TaxelSets::Move(int rows, int columns, TaxelRows& taxels) const {
  TaxelRows moved = {};
  for (int row = std::max(0, -rows); row < std::min(rows_, rows_ - rows);
       ++row) {
    moved[row + rows] = Turn(taxels[row], columns);
  }
  taxels = moved;
}

void TaxelSets::Add(const TaxelRows& more, TaxelRows& taxels) const {
  for (int row = 0; row < rows_; ++row) taxels[row] |= more[row];
}

void TaxelSets::Remove(const TaxelRows& some, TaxelRows& taxels) const {
  for (int row = 0; row < rows_; ++row) taxels[row] &= ~some[row];
}

uint64_t TaxelSets::Turn(uint64_t row, int columns) const {
  if (wrap_) columns = (columns % columns_ + columns_) % columns_;
  if (columns == 0) return row;
  if (std::abs(columns) >= columns_) return 0;
  if (columns < 0) return row >> -columns;
  const uint64_t moved = row << columns & all_;
  return wrap_ ? moved | row >> (columns_ - columns) : moved;
}

}  // namespace tactus
