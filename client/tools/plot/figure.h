// File: figure.h
//
// Figures for people as plain data, and the one call that draws them: line
// plots, scatter plots with a Pareto front, grouped bars, confusion matrices.
//
//   LinePlot plot;
//   plot.title = "Accuracy while the touch lasts";
//   plot.x = {.title = "time since onset (s)", .scale = AxisScale::kLog};
//   plot.y = {.title = "accuracy (%)", .low = 0, .high = 100};
//   plot.series = {{.name = "HMM", .x = {0.1, 1, 5}, .y = {41, 70, 90}}};
//   TACTUS_RETURN_IF_ERROR(WritePng(plot, "anytime.png"));
//
// A figure is white, drawn at twice its nominal size with antialiasing, in
// colours that colour-blind readers tell apart (Okabe and Ito, 2008); series
// differ in their markers as well. Legends stand above the data, never on
// them. Text is ASCII; units belong into axis titles.
//
// Plain data, owns its arrays; WritePng is thread-safe and deterministic.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace tactus::client {

enum class AxisScale { kLinear, kLog };

struct Axis {
  // Quantity and unit, e.g. "time since onset (s)".
  std::string title = {};
  AxisScale scale = AxisScale::kLinear;
  // Where the axis ends; round numbers around the data if absent or if data
  // lie beyond: a figure hides none.
  std::optional<double> low = {};
  std::optional<double> high = {};
  // Where to put labels; empty for round numbers.
  std::vector<double> ticks = {};
};

// A dashed line across the plot at a value of the y axis, named in the legend.
struct ReferenceLine {
  std::string name = {};
  double y = 0;
};

struct Series {
  std::string name = {};
  // One length; above 0 on logarithmic axes.
  std::vector<double> x = {};
  std::vector<double> y = {};
  bool markers = true;
};

// At most kMaxSeries series.
struct LinePlot {
  std::string title = {};
  Axis x = {};
  Axis y = {};
  std::vector<Series> series = {};
  std::vector<ReferenceLine> references = {};
  // A thin grey line y = x, what a perfectly calibrated model would give.
  bool diagonal = false;
};

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

struct ScatterPlot {
  std::string title = {};
  Axis x = {};
  Axis y = {};
  std::vector<ScatterSeries> series = {};
  // Joins the points that no other point of any series beats on both axes.
  bool pareto_front = false;
  Better better_x = Better::kLow;
  Better better_y = Better::kHigh;
};

struct BarSeries {
  std::string name = {};
  // One per group; absent for a bar that is not known.
  std::vector<std::optional<double>> values = {};
};

// Neighbouring groups under one heading, e.g. the feature sets of one
// algorithm.
struct BarSection {
  std::string name = {};
  std::vector<std::string> groups = {};
};

// Bars from 0 upwards, their values written above them with as many decimals
// as told. Wider with more bars.
struct BarChart {
  std::string title = {};
  Axis y = {};
  std::vector<BarSection> sections = {};
  // Values run through the groups of all sections.
  std::vector<BarSeries> series = {};
  std::vector<ReferenceLine> references = {};
  int decimals = 1;
};

// Rows are true classes, columns answers; each cell shows its count and its
// share of the row, which also is its colour.
struct ConfusionMatrix {
  std::string title = {};
  std::vector<std::string> labels = {};
  // labels x labels, not negative.
  std::vector<std::vector<int>> counts = {};
};

using Figure = std::variant<LinePlot, ScatterPlot, BarChart, ConfusionMatrix>;

// Series that the palette can tell apart.
inline constexpr int kMaxSeries = 7;
// What still can be read on one sheet: bars in a chart, classes in a matrix.
inline constexpr int kMaxBars = 200;
inline constexpr int kMaxMatrixClasses = 16;

// The bytes of the figure's PNG file. INVALID_CONFIG names what cannot be
// drawn: nothing at all, too much, lengths that differ, numbers that are not
// finite or, on a logarithmic axis, not above 0.
absl::StatusOr<std::string> EncodePng(const Figure& figure);

// IO if `path` cannot be written.
absl::Status WritePng(const Figure& figure, const std::string& path);

}  // namespace tactus::client
