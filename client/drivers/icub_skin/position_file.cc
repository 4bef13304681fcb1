#include "client/drivers/icub_skin/position_file.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "client/drivers/icub_skin/board_messages.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client::icub {
namespace {

constexpr size_t kMaxValues =
    static_cast<size_t>(kLastBoard - kFirstBoard + 1) * kBoardValues;
constexpr size_t kRowNumbers = 6;
// No link of a robot is longer.
constexpr double kMaxReachM = 10;

absl::Status BadLine(int line, absl::string_view got, absl::string_view want) {
  constexpr size_t kShown = 60;
  return InvalidConfig(absl::StrCat("position file, line ", line),
                       got.substr(0, kShown), want);
}

using Words = std::vector<absl::string_view>;

Words WordsOf(absl::string_view line) {
  const size_t comment = line.find('#');
  return absl::StrSplit(line.substr(0, comment), absl::ByAnyChar(" \t\r"),
                        absl::SkipEmpty());
}

absl::StatusOr<TaxelPosition> ParseRow(const Words& words, int line,
                                       absl::string_view text) {
  constexpr absl::string_view kWant =
      "x y z nx ny nz, finite numbers, metres below 10";
  if (words.size() < kRowNumbers) return BadLine(line, text, kWant);
  double numbers[kRowNumbers];
  for (size_t i = 0; i < kRowNumbers; ++i) {
    if (!absl::SimpleAtod(words[i], &numbers[i]) ||
        !(std::abs(numbers[i]) < kMaxReachM)) {
      return BadLine(line, text, kWant);
    }
  }
  TaxelPosition taxel;
  taxel.present = std::any_of(std::begin(numbers), std::end(numbers),
                              [](double number) { return number != 0; });
  taxel.position = {numbers[0], numbers[1], numbers[2]};
  taxel.normal = {numbers[3], numbers[4], numbers[5]};
  const double length = taxel.normal.norm();
  // Denormal numbers have no direction.
  if (length > 1e-6) {
    taxel.normal /= length;
  } else {
    taxel.normal.setZero();
  }
  return taxel;
}

// "( 3 3 3 -1 -1 )", in `words` from the second on.
absl::Status ParseRepresentatives(const Words& words, int line,
                                  absl::string_view text,
                                  std::vector<int>& representatives) {
  representatives.clear();
  for (size_t i = 1; i < words.size(); ++i) {
    absl::string_view word = words[i];
    while (!word.empty() && (word.front() == '(' || word.front() == ')')) {
      word.remove_prefix(1);
    }
    while (!word.empty() && (word.back() == '(' || word.back() == ')')) {
      word.remove_suffix(1);
    }
    if (word.empty()) continue;
    int value = 0;
    if (!absl::SimpleAtoi(word, &value) || value < -2 ||
        value >= static_cast<int>(kMaxValues) ||
        representatives.size() >= kMaxValues) {
      return BadLine(line, text, "taxel2Repr ( whole numbers from -2 )");
    }
    representatives.push_back(value);
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<TaxelPositions> ParsePositions(absl::string_view text) {
  TaxelPositions positions;
  bool in_rows = false;
  int line = 0;
  for (const absl::string_view raw : absl::StrSplit(text, '\n')) {
    ++line;
    const Words words = WordsOf(raw);
    if (words.empty()) continue;
    if (words[0].front() == '[') {
      in_rows = words[0] == "[calibration]";
    } else if (in_rows) {
      if (positions.values.size() == kMaxValues) {
        return BadLine(line, raw,
                       absl::StrCat("at most ", kMaxValues, " rows"));
      }
      TACTUS_ASSIGN_OR_RETURN(TaxelPosition taxel, ParseRow(words, line, raw));
      positions.values.push_back(taxel);
    } else if (words[0] == "name" && words.size() > 1) {
      positions.name = std::string(words[1]);
    } else if (words[0] == "taxel2Repr") {
      TACTUS_RETURN_IF_ERROR(
          ParseRepresentatives(words, line, raw, positions.representatives));
    }
  }
  if (std::none_of(positions.values.begin(), positions.values.end(),
                   [](const TaxelPosition& t) { return t.present; })) {
    return InvalidConfig("position file", "no taxel",
                         "a line [calibration] and a row for each value");
  }
  return positions;
}

}  // namespace tactus::internal::client::icub
