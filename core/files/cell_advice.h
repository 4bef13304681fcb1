// File: cell_advice.h
//
// What to do about a cell of a table that is no number, by what it looks like.
//
//   CellAdvice("12:30:01", '.');  // ". Dates are not read; write times as ..."
//   CellAdvice("label", '.');     // empty: nothing is known
//
// Thread-safe: a free function without state.
#pragma once

#include <string>

#include "absl/strings/string_view.h"

namespace tactus::internal {

// A sentence that begins with a full stop and a blank, or nothing. `decimal` is
// the decimal sign of the file, '.' or ','.
std::string CellAdvice(absl::string_view cell, char decimal);

}  // namespace tactus::internal
