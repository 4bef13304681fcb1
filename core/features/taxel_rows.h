// File: taxel_rows.h
//
// Sets of taxels as one word per row, bit c of word r being the taxel in row r
// and column c: how regions overlap and how near they are. What is done to a
// set costs as many rows as it spans, whatever the skin's size.
//
//   const TaxelSets sets(layout);
//   TaxelRows grown = region.rows;
//   sets.Grow(grown);
//   if (sets.Overlap(grown, other.rows) > 0) JoinThem();
//
// Plain data; thread-safe. Nothing allocates.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "core/base/limits.h"
#include "core/skin/layout.h"

namespace tactus::internal {

class TaxelRows {
 public:
  TaxelRows() = default;
  TaxelRows(const TaxelRows&) = default;
  TaxelRows& operator=(const TaxelRows& other) {
    const int end = std::max(end_, other.end_);
    for (int row = std::min(first_, other.first_); row < end; ++row) {
      words_[row] = other.words_[row];
    }
    first_ = other.first_;
    end_ = other.end_;
    columns_ = other.columns_;
    return *this;
  }

  void Clear() {
    std::fill(words_.begin() + std::min(first_, end_), words_.begin() + end_,
              uint64_t{0});
    first_ = limits::kMaxRows;
    end_ = 0;
    columns_ = 0;
  }
  void Add(int row, uint64_t columns) {
    words_[row] |= columns;
    first_ = std::min(first_, row);
    end_ = std::max(end_, row + 1);
    columns_ |= columns;
  }

  uint64_t operator[](int row) const { return words_[row]; }
  // All rows; those beyond the skin are 0.
  std::span<const uint64_t> words() const { return words_; }
  // Rows before first() and from end() on have no taxel.
  int first() const { return first_; }
  int end() const { return end_; }

 private:
  friend class TaxelSets;

  std::array<uint64_t, limits::kMaxRows> words_ = {};
  int first_ = limits::kMaxRows;
  int end_ = 0;
  // Other columns have no taxel.
  uint64_t columns_ = 0;
};

class TaxelSets {
 public:
  explicit TaxelSets(const SkinLayout& layout);

  // Taxels that both have.
  int Overlap(const TaxelRows& a, const TaxelRows& b) const;
  bool Overlaps(const TaxelRows& a, const TaxelRows& b) const;
  int Count(const TaxelRows& taxels) const;
  // Adds the eight neighbours of each taxel, across the seam of a skin that
  // wraps.
  void Grow(TaxelRows& taxels) const;
  // Moves all taxels. Those that leave the skin are gone; columns of a skin
  // that wraps come in again on the other side.
  void Move(int rows, int columns, TaxelRows& taxels) const;
  void Add(const TaxelRows& more, TaxelRows& taxels) const;
  void Remove(const TaxelRows& some, TaxelRows& taxels) const;

 private:
  // The row moved to higher columns, or to lower ones if below 0.
  uint64_t Turn(uint64_t row, int columns) const;
  // The row with its neighbours on both sides.
  uint64_t Widen(uint64_t row) const;

  int rows_;
  int columns_;
  bool wrap_;
  uint64_t all_;
};

}  // namespace tactus::internal
