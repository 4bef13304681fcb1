// File: scatter_plot.h
//
// ScatterPlot: labelled points on two axes, with the Pareto front of all of
// them: a dashed staircase, and a ring around each point on it.
//
//   ScatterPlot plot;
//   plot.title = "Run time and error";
//   plot.x = {.title = "time (ns)", .scale = AxisScale::kLog};
//   plot.y = {.title = "error (%)"};
//   plot.series = {{"HMMs", {{240, 5.5, "1 HMM"}, {390, 4.75, "5 HMMs"}}}};
//   plot.pareto_front = true;
//   TACTUS_RETURN_IF_ERROR(DrawFigure(plot, "frontier.png"));
//
// Plain data; owns its arrays.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "tools/figures/axis.h"

namespace tactus::internal::client {

struct ScatterPoint {
  double x = 0;
  double y = 0;
  // Written beside the point; may be empty.
  std::string label = {};
};

struct ScatterSeries {
  std::string name = {};
  std::vector<ScatterPoint> points = {};
};

// Which end of an axis is the better one.
enum class Better { kLow, kHigh };

// At most kMaxSeries series.
struct ScatterPlot {
  std::string title = {};
  std::string subtitle = {};
  Axis x = {};
  Axis y = {};
  std::vector<ScatterSeries> series = {};
  // Joins the points that no other point of any series beats on both axes.
  bool pareto_front = false;
  Better better_x = Better::kLow;
  Better better_y = Better::kHigh;
};

// The script that draws the plot. INVALID_CONFIG names what cannot be drawn:
// no series or too many, numbers that do not fit the axis.
absl::StatusOr<GnuplotScript> ScriptOf(const ScatterPlot& plot);

}  // namespace tactus::internal::client
