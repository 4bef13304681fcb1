// File: number_text.h
//
// Text files of numbers, a row per line: comma-separated tables and what
// loggers, spreadsheets and NumPy write instead of them.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const NumberText table,
//       ParseNumberText("a.csv", "time;force\n0;0,5\n1;0,75\n", {}));
//   table.header;  // {"time", "force"}
//   table.found;   // "cells are separated by semicolons, ..."
//
// What NumberTextFormat does not say is detected:
//   - the delimiter: comma, semicolon, tab, | or blanks, by which of them most
//     lines are numbers;
//   - the decimal sign: a comma if a cell has one that separates no cells. It
//     is refused if it could as well separate thousands;
//   - the header: a first line of names, or of numbers in order (0, 1, 2 ...).
// Not read as numbers: lines that begin with #, % or //, empty lines, one empty
// cell at the end of every line, and a column without a name that counts the
// lines (an index). Cells may be quoted. A cell that is no finite number is an
// error in every line.
//
// Thread-safe: a free function without state.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace tactus::internal {

struct NumberTextFormat {
  // ',', ';', '\t', '|' or ' ' (runs of blanks and tabs); 0: detected.
  char delimiter = 0;
  // '.' or ','; 0: detected.
  char decimal = 0;
  // Lines before the numbers without those of comments; the first one that has
  // a cell per column names the columns. Below 0: detected.
  int header_lines = -1;
  // A first line of 2 or 3 numbers in order holds numbers. Else it is refused,
  // because it may be a header.
  bool doubtful_line_is_numbers = false;
};

struct NumberText {
  // Names of the columns; empty if no line has them.
  std::vector<std::string> header;
  // [rows x columns].
  std::vector<double> numbers;
  size_t columns = 0;
  // Says how the file was read, for people; empty if the format said it all.
  std::string found;
};

// TRIAL_FILE_INVALID with `path`, the line, the column and what was found.
absl::StatusOr<NumberText> ParseNumberText(const std::string& path,
                                           absl::string_view text,
                                           const NumberTextFormat& format);

}  // namespace tactus::internal
