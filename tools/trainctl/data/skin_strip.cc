#include "tools/trainctl/data/skin_strip.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "opencv2/core.hpp"
#include "opencv2/imgproc.hpp"

namespace tactus::internal::client {
namespace {

// Taxels around the contact that a window shows.
constexpr int kAround = 2;
constexpr int kOutline = 2;  // pixels

// The stretch of a line of taxels, or of a ring, that holds all set ones:
// first and count.
std::pair<int, int> StretchOf(const std::vector<bool>& set, bool ring) {
  const int size = static_cast<int>(set.size());
  const auto first = std::ranges::find(set, true);
  if (first == set.end()) return {0, size};
  // The longest run of unset ones is what the stretch leaves out.
  int longest = 0;
  int after_longest = static_cast<int>(first - set.begin());
  int last = after_longest;
  for (int i = after_longest + 1; i < size; ++i) {
    if (!set[i]) continue;
    if (ring && i - last - 1 > longest) {
      longest = i - last - 1;
      after_longest = i;
    }
    last = i;
  }
  const int begin = static_cast<int>(first - set.begin());
  const int outside = size - (last - begin + 1);
  if (!ring || outside >= longest) return {begin, last - begin + 1};
  return {after_longest, size - longest};
}

// The stretch with more taxels around it: at least `least` of them if the skin
// has so many. On a line it ends at the edges.
std::pair<int, int> Widened(std::pair<int, int> stretch, int least, int size,
                            bool ring) {
  auto [first, count] = stretch;
  const int wanted = std::min(size, std::max(least, count + 2 * kAround));
  first -= (wanted - count) / 2;
  if (!ring) first = std::clamp(first, 0, size - wanted);
  return {(first + size) % size, wanted};
}

bool IsValid(const SkinLayout& layout, int taxel) {
  return layout.mask.empty() || layout.mask[taxel] != 0;
}

// Values of the window: 0 to 255 of `largest`, and 255 where in contact.
struct WindowValues {
  cv::Mat1b force;
  cv::Mat1b contact;
};

WindowValues ValuesIn(const SkinLayout& layout, const SkinWindow& window,
                      std::span<const float> taxels, double largest) {
  WindowValues values = {cv::Mat1b(window.rows, window.columns),
                         cv::Mat1b(window.rows, window.columns)};
  for (int r = 0; r < window.rows; ++r) {
    for (int c = 0; c < window.columns; ++c) {
      const int row = window.first_row + r;
      const int column = (window.first_column + c) % layout.columns;
      const int taxel = row * layout.columns + column;
      const double force = IsValid(layout, taxel) ? taxels[taxel] : 0;
      values.force(r, c) = static_cast<uint8_t>(
          std::lround(255 * std::clamp(force / largest, 0., 1.)));
      values.contact(r, c) = force >= layout.contact_threshold ? 255 : 0;
    }
  }
  return values;
}

cv::Mat3b Coloured(const cv::Mat1b& values) {
  cv::Mat coloured;
  cv::applyColorMap(values, coloured, cv::COLORMAP_INFERNO);
  return coloured;
}

// The window's picture of `size` pixels, in OpenCV's order of colours.
cv::Mat3b PictureOf(const WindowValues& values, cv::Size size) {
  cv::Mat3b picture;
  cv::resize(Coloured(values.force), picture, size, 0, 0, cv::INTER_NEAREST);
  cv::Mat1b contact;
  cv::resize(values.contact, contact, size, 0, 0, cv::INTER_NEAREST);
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(contact, outlines, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
  cv::drawContours(picture, outlines, -1, {255, 255, 255}, kOutline);
  return picture;
}

}  // namespace

SkinWindow WindowAround(const SkinLayout& layout,
                        const std::vector<std::vector<float>>& frames) {
  std::vector<bool> rows(layout.rows);
  std::vector<bool> columns(layout.columns);
  for (const std::vector<float>& frame : frames) {
    for (int taxel = 0; taxel < layout.taxels(); ++taxel) {
      if (!IsValid(layout, taxel) || frame[taxel] < layout.contact_threshold) {
        continue;
      }
      rows[taxel / layout.columns] = true;
      columns[taxel % layout.columns] = true;
    }
  }
  const auto row_stretch = StretchOf(rows, /*ring=*/false);
  const auto column_stretch = StretchOf(columns, layout.wrap_columns);
  const double side =
      std::max((row_stretch.second + 2 * kAround) * layout.row_pitch_m,
               (column_stretch.second + 2 * kAround) * layout.column_pitch_m);
  const auto fill = [&](double pitch) {
    return static_cast<int>(std::lround(side / pitch));
  };
  const auto [first_row, row_count] =
      Widened(row_stretch, fill(layout.row_pitch_m), layout.rows, false);
  const auto [first_column, column_count] =
      Widened(column_stretch, fill(layout.column_pitch_m), layout.columns,
              layout.wrap_columns);
  return {first_row, first_column, row_count, column_count};
}

Rgb SkinColour(double fraction) {
  const cv::Mat1b value(1, 1,
                        static_cast<uint8_t>(std::lround(255 * fraction)));
  const cv::Vec3b bgr = Coloured(value)(0, 0);
  return {bgr[2], bgr[1], bgr[0]};
}

SkinStrip DrawSkinStrip(const SkinLayout& layout, const SkinWindow& window,
                        const std::vector<std::span<const float>>& frames,
                        double largest, const SkinStripSize& size) {
  const double scale =
      std::min(size.width / (window.columns * layout.column_pitch_m),
               size.height / (window.rows * layout.row_pitch_m));
  SkinStrip strip;
  strip.picture_width = static_cast<int>(
      std::lround(scale * window.columns * layout.column_pitch_m));
  strip.picture_height =
      static_cast<int>(std::lround(scale * window.rows * layout.row_pitch_m));
  const int count = static_cast<int>(frames.size());
  strip.width = count * size.width + (count - 1) * size.gap;
  strip.height = strip.picture_height;
  strip.pixels.assign(static_cast<size_t>(strip.width) * strip.height,
                      {255, 255, 255});
  for (int i = 0; i < count; ++i) {
    const cv::Mat3b picture =
        PictureOf(ValuesIn(layout, window, frames[i], largest),
                  {strip.picture_width, strip.picture_height});
    const int left =
        i * (size.width + size.gap) + (size.width - strip.picture_width) / 2;
    strip.lefts.push_back(left);
    for (int y = 0; y < picture.rows; ++y) {
      for (int x = 0; x < picture.cols; ++x) {
        const cv::Vec3b& bgr = picture(y, x);
        strip.pixels[y * strip.width + left + x] = {bgr[2], bgr[1], bgr[0]};
      }
    }
  }
  return strip;
}

}  // namespace tactus::internal::client
