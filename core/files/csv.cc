#include "core/files/csv.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/base/text_cells.h"
#include "core/base/text_lines.h"
#include "core/files/file_bytes.h"

namespace tactus::internal {
namespace {

// What is wrong with the text of a line, empty if nothing is.
absl::string_view LineFault(absl::string_view line) {
  if (line.find('\0') != absl::string_view::npos) return "holds a zero byte";
  return IsUtf8(line) ? "" : "is not UTF-8; save the file as UTF-8";
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
  if (const auto fault = EncodingFault(*table.text_); !fault.empty()) {
    return TrialFileInvalid(path, fault);
  }
  TextLines lines(*table.text_);
  while (lines.Next()) {
    const absl::string_view line = lines.line();
    const size_t number = lines.number();
    const absl::string_view fault = LineFault(line);
    if (!fault.empty()) return table.LineError(number, fault);
    if (!table.header_.empty()) {
      TACTUS_RETURN_IF_ERROR(table.ParseRow(line, number));
    } else if (absl::StartsWith(line, "#")) {
      TACTUS_RETURN_IF_ERROR(table.ParseMetadata(line.substr(1), number));
    } else if (number > 1 || !absl::StartsWith(line, "sep=")) {
      TACTUS_RETURN_IF_ERROR(table.ParseHeader(line, number));
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

absl::Status CsvTable::Split(absl::string_view line, size_t number,
                             std::vector<absl::string_view>* cells) {
  if (!SplitCells(line, delimiter_, cells)) {
    return LineError(number,
                     "has a quote that is not closed, or text behind "
                     "one; a cell takes one line");
  }
  for (absl::string_view& cell : *cells) {
    if (!absl::StrContains(cell, "\"\"")) continue;
    cell = unquoted_.emplace_back(absl::StrReplaceAll(cell, {{"\"\"", "\""}}));
  }
  return absl::OkStatus();
}

absl::Status CsvTable::ParseHeader(absl::string_view line, size_t number) {
  for (const char other : {';', '\t', '|'}) {
    if (absl::StrContains(line, ',')) break;
    if (absl::StrContains(line, other)) {
      delimiter_ = other;
      break;
    }
  }
  const auto delimiters =
      static_cast<size_t>(std::count(line.begin(), line.end(), delimiter_));
  if (delimiters > limits::kMaxCsvColumns) {
    return LineError(number,
                     absl::StrCat("has ", delimiters + 1, " columns; at most ",
                                  limits::kMaxCsvColumns, " are read"));
  }
  TACTUS_RETURN_IF_ERROR(Split(line, number, &header_));
  if (header_.size() > 1 && header_.back().empty()) header_.pop_back();
  if (header_.size() > limits::kMaxCsvColumns) {
    return LineError(number,
                     absl::StrCat("has ", header_.size(), " columns; at most ",
                                  limits::kMaxCsvColumns, " are read"));
  }
  std::set<absl::string_view> seen;
  for (const absl::string_view name : header_) {
    // The first one of pandas, which counts the rows, has no name.
    const bool index = name.empty() && seen.empty() && header_.size() > 1;
    if ((name.empty() && !index) || !seen.insert(name).second) {
      return LineError(number, absl::StrCat("column name ", Quoted(name),
                                            " is empty or repeated"));
    }
  }
  return absl::OkStatus();
}

absl::Status CsvTable::ParseRow(absl::string_view line, size_t number) {
  std::vector<absl::string_view> cells;
  TACTUS_RETURN_IF_ERROR(Split(line, number, &cells));
  if (cells.size() == header_.size() + 1 && cells.back().empty()) {
    cells.pop_back();
  }
  const bool empty = std::all_of(cells.begin(), cells.end(),
                                 [](const auto& cell) { return cell.empty(); });
  if (empty && cells.size() == header_.size()) return absl::OkStatus();
  if (cells.size() != header_.size()) {
    return LineError(
        number, absl::StrCat("has ", cells.size(), " cells; the header has ",
                             header_.size(), ", separated by ",
                             DelimiterName(delimiter_)));
  }
  if (cells_.size() + cells.size() > limits::kMaxCsvCells) {
    return LineError(number,
                     absl::StrCat("is beyond the ", limits::kMaxCsvCells,
                                  " cells that are read of a file"));
  }
  cells_.insert(cells_.end(), cells.begin(), cells.end());
  lines_.push_back(number);
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
  return LineError(lines_[row], message);
}

absl::Status CsvTable::LineError(size_t number,
                                 absl::string_view message) const {
  return TrialFileInvalid(path_, absl::StrCat("line ", number, ": ", message));
}

}  // namespace tactus::internal
