// File: skin_strip.h
//
// SkinStrip: pictures of a skin side by side, one per moment of a contact. Each
// shows the same window around the contact; brighter taxels carry more force,
// and a white line runs around those in contact.
//
//   const SkinWindow window = WindowAround(layout, frames);
//   const SkinStrip strip =
//       DrawSkinStrip(layout, window, pictures, {.width = 140, .height = 150,
//                                                .gap = 10});
//   strip.pixels;  // strip.height x strip.width pixels
//
// The colours are those of matplotlib's "inferno": equal steps of force look
// equally large, also in grey. Drawn with OpenCV. Plain data and free functions
// without state; thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/skin/layout.h"

namespace tactus::internal::client {

// A part of the skin. Columns count on past the last one where they wrap.
struct SkinWindow {
  int first_row = 0;
  int first_column = 0;
  int rows = 0;
  int columns = 0;
};

// The window around all taxels that are in contact in some of the frames, with
// two taxels around them, about as wide as it is high.
SkinWindow WindowAround(const SkinLayout& layout,
                        const std::vector<std::vector<float>>& frames);

using Rgb = std::array<uint8_t, 3>;

// The colour of `fraction` of the largest force, 0 to 1.
Rgb SkinColour(double fraction);

// Pixels: the space of one picture, and between two of them.
struct SkinStripSize {
  int width = 0;
  int height = 0;
  int gap = 0;
};

struct SkinStrip {
  int width = 0;
  int height = 0;
  // Row-major; white between the pictures.
  std::vector<Rgb> pixels;
  // Left edge of each picture, and their common size.
  std::vector<int> lefts;
  int picture_width = 0;
  int picture_height = 0;

  const Rgb& At(int x, int y) const { return pixels[y * width + x]; }
};

// One picture per element of `frames`, each rows x columns taxels of `layout`,
// as large as its space allows with the skin's pitches. A taxel at `largest` (>
// 0) has the last colour.
SkinStrip DrawSkinStrip(const SkinLayout& layout, const SkinWindow& window,
                        const std::vector<std::span<const float>>& frames,
                        double largest, const SkinStripSize& size);

}  // namespace tactus::internal::client
