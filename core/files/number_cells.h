// File: number_cells.h
//
// Cells of tables as numbers, and what else stands in their place.
//
//   double value = 0;
//   ParseCell("0,5", ',', &value);  // true, 0.5
//   IsMissing("NaN");               // true
//
// Thread-safe: free functions without state.
#pragma once

#include <vector>

#include "absl/strings/string_view.h"

namespace tactus::internal {

// Parses a finite number whose decimal sign is `decimal`, '.' or ','.
bool ParseCell(absl::string_view cell, char decimal, double* value);

// True for a number with either decimal sign.
bool IsNumber(absl::string_view cell);

// True for what programs write where there is no number: nothing, NaN, NA,
// null, inf, #VALUE! and the like.
bool IsMissing(absl::string_view cell);

// True if the signs of a cell may separate thousands: "1,234", "12.345.678".
bool MayHaveThousands(absl::string_view cell, char sign = ',');

// A cell whose point may separate thousands, not decimals, and the place of its
// row: each point of its column may, and other numbers of the column have none.
// No cell if there is no such column.
struct DoubtfulPoint {
  size_t row = 0;
  absl::string_view cell;
};
DoubtfulPoint FindDoubtfulPoint(
    const std::vector<std::vector<absl::string_view>>& rows);

// True if the cells are first, first + 1, first + 2 ...
bool InOrder(const std::vector<absl::string_view>& cells, double* first);

}  // namespace tactus::internal
