// File: frame.h
//
// What line plots, scatter plots and bars share: where the plot stands on the
// sheet, its title, axes, grid and legend.
//
//   PlotFrame frame(canvas, {.title = plot.title, ...});
//   canvas.Marker(0, frame.At(x, y), 7, SeriesColour(0));
//
// Draws on the canvas given, which must outlive the call. Free of state
// besides its own numbers; thread-compatible.
#pragma once

#include <string>
#include <vector>

#include "client/tools/plot/canvas.h"
#include "client/tools/plot/ticks.h"

namespace tactus::client {

// Sizes of text, points.
inline constexpr double kTitleSize = 14;
inline constexpr double kAxisTitleSize = 12;
inline constexpr double kTickSize = 10.5;

struct LegendEntry {
  enum class Kind { kLine, kMarker, kLineWithMarker, kBox, kDashed };
  std::string name = {};
  Kind kind = Kind::kLine;
  // Colour and shape of the series; kDashed: which reference line.
  int index = 0;
};

struct FrameSpec {
  std::string title = {};
  std::string x_title = {};
  std::string y_title = {};
  PlotScale x = {};
  PlotScale y = {};
  std::vector<LegendEntry> legend = {};
  // Above the plot, for values of bars that reach its end.
  double extra_top = 0;
  // Below the plot, for labels that are not ticks of the x axis.
  double extra_bottom = 0;
  bool grid_x = true;
};

class PlotFrame {
 public:
  // Lays out and draws all but the data; thins the ticks to where their labels
  // stand apart.
  PlotFrame(Canvas& canvas, double width, double height, FrameSpec spec);

  const Box& plot() const { return plot_; }
  const PlotScale& x() const { return spec_.x; }
  const PlotScale& y() const { return spec_.y; }
  Point At(double x, double y) const;
  double AtX(double x) const;
  double AtY(double y) const;

  // A dashed line at `y`, dashed as the index-th in the legend.
  void DrawReference(Canvas& canvas, int index, double y) const;

 private:
  FrameSpec spec_;
  Box plot_;
};

// Legend entries laid in rows of at most `width`; returns their height.
// Without a canvas nothing is drawn.
double LayLegend(const std::vector<LegendEntry>& entries, Point top_left,
                 double width, Canvas* canvas);

}  // namespace tactus::client
