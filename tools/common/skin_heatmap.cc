#include "tools/common/skin_heatmap.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <vector>

namespace tactus::internal::client {
namespace {

// From grey over purple, red and orange to a light yellow.
constexpr int kColours[] = {234, 53,  89,  125, 161, 197,
                            202, 208, 214, 220, 226, 230};
constexpr char kCharacters[] = ".:-=+*#%@";
constexpr int kMaskedColour = 242;
constexpr char kMaskedCharacter = 'x';

// A taxel in contact is shown as at least this fraction of the full scale.
constexpr double kLeastTouch = 1.0 / 9;

// The part of `fraction`, 0 to 1, among `count` steps.
int StepOf(double fraction, int count) {
  if (!(fraction > 0)) return 0;
  return static_cast<int>(std::min(fraction * count, count - 1.));
}

// How many dots a taxel has along one side, or how many taxels share a dot.
struct Zoom {
  int dots = 1;
  int taxels = 1;

  int Length(int size) const { return (size + taxels - 1) / taxels * dots; }
};

Zoom Fit(int taxels, int dots) {
  if (dots < 1) return {.dots = 1, .taxels = std::max(taxels, 1)};
  if (taxels > dots) return {.dots = 1, .taxels = (taxels + dots - 1) / dots};
  return {.dots = dots / taxels, .taxels = 1};
}

// A dot's largest load, as a fraction of the full scale; below 0 if all its
// taxels are masked.
class Dots {
 public:
  Dots(const SkinLayout& layout, std::span<const float> values,
       double full_scale, const Zoom& down, const Zoom& across)
      : rows_(down.Length(layout.rows)),
        columns_(across.Length(layout.columns)),
        loads_(static_cast<size_t>(rows_) * columns_, -1) {
    for (int y = 0; y < rows_; ++y) {
      for (int x = 0; x < columns_; ++x) {
        double& load = loads_[static_cast<size_t>(y) * columns_ + x];
        const int row = y / down.dots * down.taxels;
        const int column = x / across.dots * across.taxels;
        for (int r = row; r < std::min(row + down.taxels, layout.rows); ++r) {
          for (int c = column;
               c < std::min(column + across.taxels, layout.columns); ++c) {
            const int taxel = r * layout.columns + c;
            if (!layout.mask.empty() && layout.mask[taxel] == 0) continue;
            const bool touched = values[taxel] >= layout.contact_threshold;
            load = std::max(load, std::max(values[taxel] / full_scale,
                                           touched ? kLeastTouch : 0));
          }
        }
      }
    }
  }

  int rows() const { return rows_; }
  int columns() const { return columns_; }
  double At(int y, int x) const {
    return loads_[static_cast<size_t>(y) * columns_ + x];
  }

 private:
  const int rows_;
  const int columns_;
  std::vector<double> loads_;
};

int DotColour(double load) {
  return load < 0 ? kMaskedColour : HeatColour(load);
}

}  // namespace

int HeatColour(double fraction) {
  return kColours[StepOf(fraction, std::size(kColours))];
}

char HeatCharacter(double fraction) {
  return kCharacters[StepOf(fraction, std::size(kCharacters) - 1)];
}

HeatmapArea DrawHeatmap(const SkinLayout& layout, std::span<const float> values,
                        double full_scale, const HeatmapArea& area, bool colour,
                        TextCanvas& canvas) {
  // A half of a character is about as high as it is wide.
  const int halves = colour ? 2 : 1;
  Zoom down = Fit(layout.rows, halves * area.rows);
  Zoom across = Fit(layout.columns, area.columns);
  // Without colours a dot is twice as high as it is wide.
  const int most_across = colour ? 2 * down.dots : 4 * down.dots;
  across.dots = std::min(across.dots, most_across);
  down.dots = std::min(down.dots, std::max(1, 2 * across.dots));
  const Dots dots(layout, values, full_scale, down, across);
  for (int y = 0; y < dots.rows(); y += halves) {
    for (int x = 0; x < dots.columns(); ++x) {
      const int column = area.column + x;
      const int row = area.row + y / halves;
      const double upper = dots.At(y, x);
      if (!colour) {
        const char c = upper < 0 ? kMaskedCharacter : HeatCharacter(upper);
        canvas.Put(column, row, std::string(1, c));
      } else if (y + 1 < dots.rows()) {
        canvas.Put(column, row, "▀", DotColour(upper),
                   DotColour(dots.At(y + 1, x)));
      } else {
        canvas.Put(column, row, "▀", DotColour(upper));
      }
    }
  }
  return {area.column, area.row, dots.columns(),
          (dots.rows() + halves - 1) / halves};
}

}  // namespace tactus::internal::client
