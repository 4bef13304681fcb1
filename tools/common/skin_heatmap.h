// File: skin_heatmap.h
//
// Draws a skin's frame on a TextCanvas. With colours, each character shows two
// taxels above each other; without, a taxel is one character.
//
//   const HeatmapArea drawn = DrawHeatmap(
//       layout, values, /*full_scale=*/2, {.columns = 48, .rows = 16},
//       /*colour=*/true, canvas);
//
// Taxels are enlarged by whole numbers as far as the area allows, at most twice
// as much in one direction as in the other. A skin that is larger than the area
// is reduced: a dot shows the largest of its taxels. Masked taxels are marked,
// and taxels in contact always differ from others.
// Thread-safe: free functions without state.
#pragma once

#include <span>

#include "core/skin/layout.h"
#include "tools/common/text_canvas.h"

namespace tactus::internal::client {

// In characters.
struct HeatmapArea {
  int column = 0;
  int row = 0;
  int columns = 0;
  int rows = 0;
};

// Colours of the palette from no load to the full scale.
int HeatColour(double fraction);
// The same as a character.
char HeatCharacter(double fraction);

// Draws `values`, rows x columns of `layout`, in the upper left of `area`, and
// returns what was used of it. A taxel at `full_scale` (> 0) has the last
// colour.
HeatmapArea DrawHeatmap(const SkinLayout& layout, std::span<const float> values,
                        double full_scale, const HeatmapArea& area, bool colour,
                        TextCanvas& canvas);

}  // namespace tactus::internal::client
