// File: taxel_cell.h
//
// TaxelCell: the taxel that a line of a CSV file is about.
//
//   TACTUS_ASSIGN_OR_RETURN(const int taxel,
//                           TaxelCell(table, row, column, 384));
//   if (taxel == kEachTaxel) return;
//
// Thread-safe: a free function without state.
#pragma once

#include "absl/status/statusor.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "core/files/csv.h"

namespace tactus::internal::client {

// The taxel `*`.
inline constexpr int kEachTaxel = -1;

// TRIAL_FILE_INVALID, with the line, unless the cell is `*` or from 0 to
// `taxels` - 1.
inline absl::StatusOr<int> TaxelCell(const CsvTable& table, size_t row,
                                     size_t column, int taxels) {
  const absl::string_view text = table.text(row, column);
  int taxel = kEachTaxel;
  if (text != "*" &&
      (!absl::SimpleAtoi(text, &taxel) || taxel < 0 || taxel >= taxels)) {
    return table.RowError(
        row,
        absl::StrCat("taxel is ", text, "; it must be * or 0 to ", taxels - 1));
  }
  return taxel;
}

}  // namespace tactus::internal::client
