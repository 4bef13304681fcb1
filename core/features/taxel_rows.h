// File: taxel_rows.h
//
// Sets of taxels as one word per row, bit c of word r being the taxel in row r
// and column c: how regions overlap and how near they are.
//
//   const TaxelSets sets(layout);
//   TaxelRows grown = region.rows;
//   sets.Grow(grown);
//   if (sets.Overlap(grown, other.rows) > 0) JoinThem();
//
// Plain data; thread-safe. Nothing allocates.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/limits.h"
#include "core/skin/layout.h"

namespace tactus {

// Rows beyond those of the skin are 0.
using TaxelRows = std::array<uint64_t, limits::kMaxRows>;

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

  int rows_;
  int columns_;
  bool wrap_;
  uint64_t all_;
};

}  // namespace tactus
