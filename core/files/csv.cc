#include "core/files/csv.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/files/file_bytes.h"

namespace tactus {
namespace {

// What is wrong with the text of a line, empty if nothing is.
absl::string_view LineFault(absl::string_view line) {
  if (line.find('\0') != absl::string_view::npos) return "holds a zero byte";
  return IsUtf8(line) ? "" : "is not UTF-8";
}

}  // namespace

bool ParseNumber(absl::string_view text, double* value) {
  // SimpleAtod would skip surrounding blanks and take "inf" and "nan".
  if (text.empty() || absl::ascii_isspace(text.front()) ||
      absl::ascii_isspace(text.back())) {
    return false;
  }
  return absl::SimpleAtod(text, value) && std::isfinite(*value);
}

absl::StatusOr<CsvTable> CsvTable::Read(const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(std::string text,
                          ReadFileBytes(path, limits::kMaxCsvBytes));
  return Parse(path, std::move(text));
}

absl::StatusOr<CsvTable> CsvTable::Parse(const std::string& path,
                                         std::string text) {
  CsvTable table;
  table.path_ = path;
  table.text_ = std::make_unique<std::string>(std::move(text));
  absl::string_view rest = *table.text_;
  absl::ConsumePrefix(&rest, "\xEF\xBB\xBF");
  for (size_t number = 1; !rest.empty(); ++number) {
    const size_t end = std::min(rest.find('\n'), rest.size());
    absl::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    absl::ConsumeSuffix(&line, "\r");
    const absl::string_view fault = LineFault(line);
    if (!fault.empty()) return table.LineError(number, fault);
    if (!table.header_.empty()) {
      TACTUS_RETURN_IF_ERROR(table.ParseRow(line, number));
    } else if (absl::StartsWith(line, "#")) {
      TACTUS_RETURN_IF_ERROR(table.ParseMetadata(line.substr(1), number));
    } else {
      TACTUS_RETURN_IF_ERROR(table.ParseHeader(line, number));
      table.lines_before_rows_ = number;
    }
  }
  if (table.header_.empty()) {
    return TrialFileInvalid(path, "has no header line");
  }
  return table;
}

absl::Status CsvTable::ParseMetadata(absl::string_view line, size_t number) {
  const std::vector<absl::string_view> parts =
      absl::StrSplit(line, absl::MaxSplits('=', 1));
  if (parts.size() != 2) {
    return LineError(number, absl::StrCat("# is followed by ", Quoted(line),
                                          "; it must be key=value"));
  }
  if (metadata_.size() == limits::kMaxCsvMetadata) {
    return LineError(number, absl::StrCat("is one # line too many; a file has "
                                          "at most ",
                                          limits::kMaxCsvMetadata));
  }
  const std::string key(absl::StripAsciiWhitespace(parts[0]));
  for (const auto& [earlier, value] : metadata_) {
    if (earlier == key) {
      return LineError(number, absl::StrCat("key ", Quoted(key), " repeated"));
    }
  }
  metadata_.emplace_back(key, absl::StripAsciiWhitespace(parts[1]));
  return absl::OkStatus();
}

absl::Status CsvTable::ParseHeader(absl::string_view line, size_t number) {
  const auto commas =
      static_cast<size_t>(std::count(line.begin(), line.end(), ','));
  if (commas >= limits::kMaxCsvColumns) {
    return LineError(number,
                     absl::StrCat("has ", commas + 1, " columns; at most ",
                                  limits::kMaxCsvColumns, " are read"));
  }
  header_ = absl::StrSplit(line, ',');
  std::set<absl::string_view> seen;
  for (const absl::string_view name : header_) {
    if (name.empty() || !seen.insert(name).second) {
      return LineError(number, absl::StrCat("column name ", Quoted(name),
                                            " is empty or repeated"));
    }
  }
  return absl::OkStatus();
}

absl::Status CsvTable::ParseRow(absl::string_view line, size_t number) {
  const size_t before = cells_.size();
  for (const absl::string_view cell : absl::StrSplit(line, ',')) {
    if (absl::StrContains(cell, '"')) {
      return LineError(number, "quoted cells are not supported");
    }
    if (cells_.size() == limits::kMaxCsvCells) {
      return LineError(number,
                       absl::StrCat("is beyond the ", limits::kMaxCsvCells,
                                    " cells that are read of a file"));
    }
    cells_.push_back(cell);
  }
  if (cells_.size() - before != header_.size()) {
    return LineError(number,
                     absl::StrCat("has ", cells_.size() - before,
                                  " cells; the header has ", header_.size()));
  }
  return absl::OkStatus();
}

bool CsvTable::Has(absl::string_view column) const {
  return std::find(header_.begin(), header_.end(), column) != header_.end();
}

absl::StatusOr<size_t> CsvTable::Column(absl::string_view column) const {
  const auto found = std::find(header_.begin(), header_.end(), column);
  if (found == header_.end()) {
    return TrialFileInvalid(path_, absl::StrCat("has no column ", column));
  }
  return static_cast<size_t>(found - header_.begin());
}

absl::StatusOr<double> CsvTable::Number(size_t row, size_t column) const {
  double value = 0;
  if (!ParseNumber(text(row, column), &value)) {
    return RowError(
        row, absl::StrCat(header_[column], " is ", Quoted(text(row, column)),
                          "; it must be a finite number"));
  }
  return value;
}

absl::Status CsvTable::RowError(size_t row, absl::string_view message) const {
  return LineError(lines_before_rows_ + row + 1, message);
}

absl::Status CsvTable::LineError(size_t number,
                                 absl::string_view message) const {
  return TrialFileInvalid(path_, absl::StrCat("line ", number, ": ", message));
}

}  // namespace tactus
