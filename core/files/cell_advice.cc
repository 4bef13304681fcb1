#include "core/files/cell_advice.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_replace.h"
#include "core/files/csv.h"
#include "core/files/number_cells.h"

namespace tactus::internal {
namespace {

bool LooksLikeDate(absl::string_view cell) {
  const auto digits = std::count_if(
      cell.begin(), cell.end(), [](char c) { return absl::ascii_isdigit(c); });
  const auto has = [&](char sign, int more_than) {
    return std::count(cell.begin(), cell.end(), sign) > more_than;
  };
  return digits >= 4 && (has(':', 0) || has('-', 1) || has('/', 1));
}

// True for "1 234", "1'234", "1.234,5" and the like.
bool HasThousands(absl::string_view cell) {
  const std::string plain = absl::StrReplaceAll(
      cell, {{"\u00a0", " "}, {"\u202f", " "}, {"\u2019", "'"}});
  for (const char sign : {' ', '\'', '.', ',', '_'}) {
    const absl::string_view whole =
        absl::string_view(plain).substr(0, plain.find(sign == ',' ? '.' : ','));
    if (MayHaveThousands(whole, sign)) return true;
  }
  return false;
}

// True for "1.5N" and "20 ms": a number and what is no part of it.
bool HasUnit(absl::string_view cell) {
  const size_t end = cell.find_first_not_of("+-.,0123456789");
  double value = 0;
  if (end == absl::string_view::npos || end == 0) return false;
  const absl::string_view number =
      absl::StripTrailingAsciiWhitespace(cell.substr(0, end));
  return ParseCell(number, '.', &value) || ParseCell(number, ',', &value);
}

}  // namespace

std::string CellAdvice(absl::string_view cell, char decimal) {
  if (IsMissing(cell)) {
    return ". It stands for a missing number: leave out the frame, or fill it "
           "in";
  }
  if (decimal == '.' && IsNumber(cell)) {
    return ". If its comma is a decimal sign, say \"decimal\": \",\" in "
           "skin.json";
  }
  if (absl::StartsWith(cell, "=")) {
    return ". It is a formula of a spreadsheet; write its value";
  }
  if (LooksLikeDate(cell)) {
    return ". Dates are not read; write times as numbers, e.g. seconds";
  }
  if (HasThousands(cell)) {
    return ". Write numbers without signs between thousands";
  }
  if (decimal == ',' && absl::StrContains(cell, '.')) {
    return ". The decimal sign of this file is a comma; if that is wrong, say "
           "\"decimal\": \".\" in skin.json";
  }
  if (HasUnit(cell)) {
    return ". Write the number alone, with e before an exponent";
  }
  return "";
}

}  // namespace tactus::internal
