// File: text_boxes.h
//
// Whether texts of a picture cover each other. Test-only.
//
//   EXPECT_EQ(CoveredTexts(script), "");
#pragma once

#include <algorithm>
#include <string>

#include "absl/strings/str_cat.h"
#include "tools/figures/gnuplot_script.h"
#include "tools/figures/label_places.h"

namespace tactus::internal::client {

// Names the first pair of texts that overlap, or the first text beyond the
// sheet, by their places in the script; empty if there is none. Letters are
// not as high as their size: a quarter of it may overlap.
inline std::string CoveredTexts(const GnuplotScript& script) {
  const auto& boxes = script.text_boxes();
  const auto inner = [](const Box& box) {
    const double margin = 0.125 * std::min(box.width(), box.height());
    return Box{box.left + margin, box.top + margin, box.right - margin,
               box.bottom - margin};
  };
  for (size_t i = 0; i < boxes.size(); ++i) {
    if (boxes[i].left < 0 || boxes[i].right > script.width() ||
        boxes[i].top < 0 || boxes[i].bottom > script.height()) {
      return absl::StrCat("text ", i, " leaves the sheet");
    }
    for (size_t j = 0; j < i; ++j) {
      if (Overlap(inner(boxes[i]), inner(boxes[j])) > 0) {
        return absl::StrCat("texts ", j, " and ", i, " overlap");
      }
    }
  }
  return "";
}

}  // namespace tactus::internal::client
