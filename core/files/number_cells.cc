#include "core/files/number_cells.h"

#include <algorithm>
#include <array>
#include <string>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/strip.h"
#include "core/files/csv.h"

namespace tactus::internal {
namespace {

// A number whose decimal sign is a comma, e.g. "-1,5e3".
bool ParseCommaNumber(absl::string_view cell, double* value) {
  const size_t comma = cell.find(',');
  if (comma == absl::string_view::npos) return ParseNumber(cell, value);
  // A digit follows, so that "1," of "1, 2" is none.
  if (absl::StrContains(cell, '.') || comma + 1 == cell.size() ||
      !absl::ascii_isdigit(cell[comma + 1])) {
    return false;
  }
  std::string point(cell);
  point[comma] = '.';
  return ParseNumber(point, value);
}

}  // namespace

bool ParseCell(absl::string_view cell, char decimal, double* value) {
  return decimal == ',' ? ParseCommaNumber(cell, value)
                        : ParseNumber(cell, value);
}

bool IsNumber(absl::string_view cell) {
  double value = 0;
  return ParseNumber(cell, &value) || ParseCommaNumber(cell, &value);
}

bool IsMissing(absl::string_view cell) {
  static constexpr std::array<absl::string_view, 15> kMissing = {
      "",    "nan",  "+nan", "-nan", "na",       "n/a",       "#n/a", "null",
      "nil", "none", "inf",  "-inf", "infinity", "-infinity", "-"};
  const std::string lower = absl::AsciiStrToLower(cell);
  return std::find(kMissing.begin(), kMissing.end(), lower) != kMissing.end() ||
         absl::StartsWith(lower, "-nan(") || absl::StartsWith(lower, "#");
}

bool MayHaveThousands(absl::string_view cell, char sign) {
  absl::ConsumePrefix(&cell, "-");
  if (cell.empty() || cell.front() == '0') return false;
  size_t digits = 0;
  size_t signs = 0;
  for (const char c : cell) {
    if (c == sign) {
      if (signs == 0 ? digits < 1 || digits > 3 : digits != 3) return false;
      ++signs;
      digits = 0;
    } else if (absl::ascii_isdigit(c)) {
      ++digits;
    } else {
      return false;
    }
  }
  return signs > 0 && digits == 3;
}

DoubtfulPoint FindDoubtfulPoint(
    const std::vector<std::vector<absl::string_view>>& rows) {
  size_t columns = 0;
  for (const auto& row : rows) columns = std::max(columns, row.size());
  for (size_t column = 0; column < columns; ++column) {
    DoubtfulPoint first;
    bool without = false;
    bool decimal = false;
    for (size_t row = 0; row < rows.size(); ++row) {
      if (column >= rows[row].size()) continue;
      const absl::string_view cell = rows[row][column];
      double value = 0;
      if (MayHaveThousands(cell, '.')) {
        if (first.cell.empty()) first = {row, cell};
      } else if (ParseNumber(cell, &value)) {
        const bool integer =
            cell.find_first_not_of("+-0123456789") == absl::string_view::npos;
        without |= integer;
        decimal |= !integer;
      }
    }
    if (!first.cell.empty() && without && !decimal) return first;
  }
  return {};
}

bool InOrder(const std::vector<absl::string_view>& cells, double* first) {
  for (size_t i = 0; i < cells.size(); ++i) {
    double value = 0;
    if (!ParseNumber(cells[i], &value)) return false;
    if (i == 0) *first = value;
    if (value != *first + static_cast<double>(i)) return false;
  }
  return !cells.empty();
}

}  // namespace tactus::internal
