// File: bar_chart.h
//
// BarChart: groups of bars from 0 upwards, each with its value above it and,
// where it is known, its 95 % interval. One row of groups per section.
//
//   BarChart chart;
//   chart.title = "Accuracy by features";
//   chart.y = {.title = "accuracy (%)", .high = 100};
//   chart.x_title = "features";
//   chart.series = {"here", "paper"};
//   chart.sections = {{"HMM", {{"force", {Bar{48, 45.7, 50.3}, Bar{39}}}}}};
//   TACTUS_RETURN_IF_ERROR(DrawFigure(chart, "accuracy.png"));
//
// Plain data; owns its arrays.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "tools/figures/axis.h"
#include "tools/figures/line_plot.h"

namespace tactus::internal::client {

struct Bar {
  double value = 0;
  // Both or none.
  std::optional<double> low = {};
  std::optional<double> high = {};
};

struct BarGroup {
  std::string name = {};
  // One per series; absent where nothing is known.
  std::vector<std::optional<Bar>> bars = {};
};

struct BarSection {
  std::string name = {};
  std::vector<BarGroup> groups = {};
};

// What can still be read on one sheet.
inline constexpr int kMaxBarsInRow = 40;
inline constexpr int kMaxBarSections = 8;

struct BarChart {
  std::string title = {};
  std::string subtitle = {};
  Axis y = {};
  // Names; at most kMaxSeries.
  std::vector<std::string> series = {};
  std::vector<BarSection> sections = {};
  // What the names of the groups are; below the last section.
  std::string x_title = {};
  std::vector<ReferenceLine> references = {};
  // Decimals of the values above the bars.
  int decimals = 1;
};

// The script that draws the chart. INVALID_CONFIG names what cannot be drawn:
// nothing at all, too much, groups whose bars are not one per series.
absl::StatusOr<GnuplotScript> ScriptOf(const BarChart& chart);

}  // namespace tactus::internal::client
