// File: line_plot.h
//
// LinePlot: curves over an axis, with intervals around their points, dashed
// reference values and, if wanted, a row of counts below.
//
//   LinePlot plot;
//   plot.title = "Accuracy over time";
//   plot.x = {.title = "time since onset (s)", .scale = AxisScale::kLog};
//   plot.y = {.title = "accuracy (%)", .low = 50, .high = 100};
//   plot.series = {{.name = "HMM", .x = {0.1, 1, 5}, .y = {61, 70, 90}}};
//   TACTUS_RETURN_IF_ERROR(DrawFigure(plot, "anytime.png"));
//
// Plain data; owns its arrays.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "tools/figures/axis.h"

namespace tactus::internal::client {

// How the intervals of a series are drawn.
enum class IntervalStyle { kBand, kBars };

struct Series {
  std::string name = {};
  // One length.
  std::vector<double> x = {};
  std::vector<double> y = {};
  // Empty, or the interval of each y.
  std::vector<double> low = {};
  std::vector<double> high = {};
  IntervalStyle interval = IntervalStyle::kBand;
  // Empty, or whether each point stands for few observations: its marker is
  // hollow, and no line leads to it.
  std::vector<bool> few = {};
  // False: the line alone is drawn, for curves of many points.
  bool markers = true;
};

// A dashed line across the plot at a value of the y axis, named in the legend.
struct ReferenceLine {
  std::string name = {};
  double y = 0;
};

// Bars below the plot, each with its number, that say how many observations
// are behind its points.
struct CountBars {
  std::string title = {};
  // Bar i reaches from edges[i] to edges[i + 1] on the plot's x axis.
  std::vector<double> edges = {};
  std::vector<int> counts = {};
};

// At most kMaxSeries series.
struct LinePlot {
  std::string title = {};
  std::string subtitle = {};
  Axis x = {};
  Axis y = {};
  std::vector<Series> series = {};
  std::vector<ReferenceLine> references = {};
  // A thin line y = x, named in the legend; empty for none.
  std::string diagonal = {};
  // Name of the hollow markers in the legend, which has them if there are any.
  std::string few_name = {};
  // Not drawn if there are no counts.
  CountBars counts = {};
};

// The script that draws the plot. INVALID_CONFIG names what cannot be drawn:
// no series or too many, lengths that differ, numbers that do not fit the axis.
absl::StatusOr<GnuplotScript> ScriptOf(const LinePlot& plot);

}  // namespace tactus::internal::client
