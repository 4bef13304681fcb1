#include "tests/support/png_image.h"

#include <zlib.h>

#include <algorithm>
#include <cstdlib>

#include "gtest/gtest.h"

namespace tactus::internal::client {
namespace {

constexpr int kChannels = 3;
constexpr uint32_t kWhite = 0xffffff;

uint32_t BigEndian(const std::string& bytes, size_t at) {
  uint32_t value = 0;
  for (size_t i = 0; i < 4; ++i) {
    value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  }
  return value;
}

// The predictor of PNG's filter type 4.
int Paeth(int left, int up, int corner) {
  const int estimate = left + up - corner;
  const int to_left = std::abs(estimate - left);
  const int to_up = std::abs(estimate - up);
  const int to_corner = std::abs(estimate - corner);
  if (to_left <= to_up && to_left <= to_corner) return left;
  return to_up <= to_corner ? up : corner;
}

// Undoes the filter of one row; `above` is the row before it.
void Unfilter(int filter, const std::vector<uint8_t>& above,
              std::vector<uint8_t>& row) {
  for (size_t i = 0; i < row.size(); ++i) {
    const int left = i < kChannels ? 0 : row[i - kChannels];
    const int corner = i < kChannels ? 0 : above[i - kChannels];
    const int guesses[] = {0, left, above[i], (left + above[i]) / 2,
                           Paeth(left, above[i], corner)};
    row[i] = static_cast<uint8_t>(row[i] + guesses[filter]);
  }
}

}  // namespace

PngImage DecodePng(const std::string& bytes) {
  constexpr size_t kHeader = 33;
  constexpr char kSignature[] = "\x89PNG\r\n\x1a\n";
  PngImage image;
  if (bytes.size() < kHeader || bytes.compare(0, 8, kSignature) != 0 ||
      bytes[24] != 8 || bytes[25] != 2 || bytes[28] != 0) {
    ADD_FAILURE() << "not a PNG file of 8-bit RGB pixels";
    return image;
  }
  const int width = static_cast<int>(BigEndian(bytes, 16));
  const int height = static_cast<int>(BigEndian(bytes, 20));
  std::string packed;
  for (size_t at = 8; at + 12 <= bytes.size();) {
    const size_t length = BigEndian(bytes, at);
    if (bytes.compare(at + 4, 4, "IDAT") == 0) {
      packed += bytes.substr(at + 8, length);
    }
    at += 12 + length;
  }
  const size_t row_bytes = static_cast<size_t>(width) * kChannels;
  std::vector<uint8_t> raw(height * (row_bytes + 1));
  uLongf size = raw.size();
  if (uncompress(raw.data(), &size,
                 reinterpret_cast<const Bytef*>(packed.data()),
                 packed.size()) != Z_OK ||
      size != raw.size()) {
    ADD_FAILURE() << "the pixels of the PNG file cannot be read";
    return image;
  }
  std::vector<uint8_t> above(row_bytes);
  image = {width, height, {}};
  for (int y = 0; y < height; ++y) {
    const auto start =
        raw.begin() + static_cast<ptrdiff_t>(y * (row_bytes + 1));
    std::vector<uint8_t> row(start + 1,
                             start + 1 + static_cast<ptrdiff_t>(row_bytes));
    Unfilter(*start, above, row);
    for (size_t i = 0; i < row_bytes; i += kChannels) {
      image.pixels.push_back(static_cast<uint32_t>(row[i]) << 16 |
                             static_cast<uint32_t>(row[i + 1]) << 8 |
                             row[i + 2]);
    }
    above = std::move(row);
  }
  return image;
}

uint32_t ColourOf(const std::string& text) {
  return static_cast<uint32_t>(std::stoul(text.substr(1), nullptr, 16));
}

std::vector<Spot> Spots(const PngImage& image, uint32_t colour, int least) {
  std::vector<bool> seen(image.pixels.size());
  std::vector<Spot> spots;
  for (int start = 0; start < static_cast<int>(seen.size()); ++start) {
    if (seen[start] || image.pixels[start] != colour) continue;
    Spot spot = {image.width, image.height, -1, -1, 0};
    std::vector<int> open = {start};
    seen[start] = true;
    while (!open.empty()) {
      const int at = open.back();
      open.pop_back();
      const int x = at % image.width;
      const int y = at / image.width;
      spot = {std::min(spot.left, x), std::min(spot.top, y),
              std::max(spot.right, x), std::max(spot.bottom, y),
              spot.pixels + 1};
      for (const auto& [dx, dy] : {std::pair(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
        if (x + dx < 0 || x + dx >= image.width || y + dy < 0 ||
            y + dy >= image.height) {
          continue;
        }
        const int next = at + dx + dy * image.width;
        if (seen[next] || image.pixels[next] != colour) continue;
        seen[next] = true;
        open.push_back(next);
      }
    }
    if (spot.pixels >= least) spots.push_back(spot);
  }
  std::ranges::sort(spots, {}, &Spot::x);
  return spots;
}

Spot Ink(const PngImage& image, int left, int top, int right, int bottom) {
  Spot ink = {right, bottom, left - 1, top - 1, 0};
  for (int y = top; y < bottom; ++y) {
    for (int x = left; x < right; ++x) {
      if (image.At(x, y) == kWhite) continue;
      ink = {std::min(ink.left, x), std::min(ink.top, y),
             std::max(ink.right, x), std::max(ink.bottom, y), ink.pixels + 1};
    }
  }
  return ink;
}

}  // namespace tactus::internal::client
