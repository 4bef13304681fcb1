// File: confusion_matrix.h
//
// ConfusionMatrix: how often contacts of each class got each answer. Rows are
// true classes, columns answers; a cell shows its count and its percentage of
// the row, which also is its colour.
//
//   ConfusionMatrix matrix = {.title = "Virtual Cody",
//                             .labels = {"HU", "SM"},
//                             .counts = {{50, 10}, {14, 46}}};
//   TACTUS_RETURN_IF_ERROR(DrawFigure(matrix, "confusion.png"));
//
// Plain data; owns its arrays.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "tools/figures/gnuplot_script.h"

namespace tactus::internal::client {

// What can still be read on one sheet.
inline constexpr int kMaxMatrixClasses = 16;

struct ConfusionMatrix {
  std::string title = {};
  // A smaller line below the title.
  std::string subtitle = {};
  std::vector<std::string> labels = {};
  // labels x labels, not negative.
  std::vector<std::vector<int>> counts = {};
};

// The script that draws the matrix. INVALID_CONFIG names what cannot be drawn:
// no class or too many, counts of another shape or below 0.
absl::StatusOr<GnuplotScript> ScriptOf(const ConfusionMatrix& matrix);

}  // namespace tactus::internal::client
