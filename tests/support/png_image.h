// File: png_image.h
//
// PngImage: the pixels of a picture that gnuplot drew, so that tests measure
// what a reader would see. Test-only; reads 8-bit RGB without interlacing,
// which is what pngcairo writes on a white background.
//
//   const PngImage image = DecodePng(bytes);
//   image.At(10, 20);                       // 0xrrggbb
//   Spots(image, ColourOf("#0072b2"));      // connected patches of a colour
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tactus::internal::client {

struct PngImage {
  int width = 0;
  int height = 0;
  // Row-major, 0xrrggbb.
  std::vector<uint32_t> pixels;

  uint32_t At(int x, int y) const { return pixels[y * width + x]; }
};

// A connected patch of one colour.
struct Spot {
  int left = 0;
  int top = 0;
  int right = 0;
  int bottom = 0;
  int pixels = 0;

  double x() const { return (left + right) / 2.; }
  double y() const { return (top + bottom) / 2.; }
  int height() const { return bottom - top + 1; }
};

// An image of no pixels, and a failed expectation, if `bytes` are no such PNG.
PngImage DecodePng(const std::string& bytes);

// 0xrrggbb of "#rrggbb".
uint32_t ColourOf(const std::string& text);

// Patches of exactly this colour of at least `least` pixels, from left to
// right.
std::vector<Spot> Spots(const PngImage& image, uint32_t colour, int least = 20);

// The patch of pixels that are not white within a part of the picture.
Spot Ink(const PngImage& image, int left, int top, int right, int bottom);

}  // namespace tactus::internal::client
