// File: text_cells.h
//
// The cells of one line of a table in text.
//
//   std::vector<absl::string_view> cells;
//   SplitCells("1;\"a;b\"; 3 ", ';', &cells);  // {"1", "a;b", "3"}
//
// Thread-safe: free functions without state.
#pragma once

#include <string>
#include <vector>

#include "absl/strings/string_view.h"

namespace tactus::internal {

// Splits at `delimiter`, or for ' ' at runs of blanks and tabs. A cell loses
// the blanks around it, and the double quotes around it if it has them;
// delimiters between quotes separate nothing. A doubled quote within quotes
// stays doubled. False if a quote is not closed, or if more than blanks follow
// one.
bool SplitCells(absl::string_view line, char delimiter,
                std::vector<absl::string_view>* cells);

// The name of a delimiter in a sentence: "commas".
std::string DelimiterName(char delimiter);

}  // namespace tactus::internal
