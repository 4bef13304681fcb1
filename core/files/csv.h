// File: csv.h
//
// A table as spreadsheets and pandas write it: optional `# key=value` lines at
// the top, one header line, then one line a row. Cells are separated by commas,
// or by semicolons, tabs or | if the header has no comma; they may be quoted,
// and lose the blanks around them. Empty lines and rows are left out, and so is
// an empty cell at the end of every line. Numbers have a decimal point whatever
// the locale. The text is UTF-8 without zero bytes.
//
//   TACTUS_ASSIGN_OR_RETURN(CsvTable table, CsvTable::Read("index.csv"));
//   TACTUS_ASSIGN_OR_RETURN(size_t object, table.Column("object"));
//   table.text(0, object);
//
// Owns its text. Thread-safe once built.
#pragma once

#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace tactus::internal {

class CsvTable {
 public:
  // IO or TRIAL_FILE_INVALID, with the line number.
  static absl::StatusOr<CsvTable> Read(const std::string& path);
  // The same for text in memory; `path` is for error messages only.
  static absl::StatusOr<CsvTable> Parse(const std::string& path,
                                        std::string text);

  const std::vector<absl::string_view>& header() const { return header_; }
  // The `# key=value` lines in order.
  const std::vector<std::pair<std::string, std::string>>& metadata() const {
    return metadata_;
  }
  size_t rows() const { return cells_.size() / header_.size(); }
  bool Has(absl::string_view column) const;
  // Position of a column; TRIAL_FILE_INVALID if there is none.
  absl::StatusOr<size_t> Column(absl::string_view column) const;
  absl::string_view text(size_t row, size_t column) const {
    return cells_[row * header_.size() + column];
  }
  // TRIAL_FILE_INVALID, with the line number, unless the cell is a finite
  // number.
  absl::StatusOr<double> Number(size_t row, size_t column) const;
  // An error about a row, with its line number.
  absl::Status RowError(size_t row, absl::string_view message) const;

 private:
  absl::Status ParseMetadata(absl::string_view line, size_t number);
  absl::Status ParseHeader(absl::string_view line, size_t number);
  absl::Status ParseRow(absl::string_view line, size_t number);
  // The cells of a line, without doubled quotes.
  absl::Status Split(absl::string_view line, size_t number,
                     std::vector<absl::string_view>* cells);
  absl::Status LineError(size_t number, absl::string_view message) const;

  std::string path_;
  // All views point into it; it does not move with the table.
  std::unique_ptr<std::string> text_;
  std::vector<std::pair<std::string, std::string>> metadata_;
  std::vector<absl::string_view> header_;
  std::vector<absl::string_view> cells_;
  // The line of each row.
  std::vector<size_t> lines_;
  char delimiter_ = ',';
  // Cells with quotes in them, which the views point into.
  std::deque<std::string> unquoted_;
};

// Parses a finite number; false otherwise. Independent of the locale.
bool ParseNumber(absl::string_view text, double* value);

}  // namespace tactus::internal
