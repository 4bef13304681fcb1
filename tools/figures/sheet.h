// File: sheet.h
//
// What stands above the axes of every chart: the title, a line below it, and
// the legend. Nothing of it covers the data.
//
//   const Box area = AddHeading(
//       {.title = "Accuracy",
//        .legend = {{"HMM", LegendSample::kLineAndMarker, 0}}}, script);
//   script.PlotArea(area);
//
// The legend is laid out here, by the widths of its names, because the columns
// of gnuplot's key are all as wide as the longest name. Free functions without
// state; thread-safe.
#pragma once

#include <string>
#include <vector>

#include "tools/figures/gnuplot_script.h"

namespace tactus::internal::client {

enum class LegendSample {
  kLineAndMarker,
  kLine,
  kMarker,
  kHollowMarker,
  kBar,
  kDashes
};

struct LegendEntry {
  std::string name = {};
  LegendSample sample = LegendSample::kLineAndMarker;
  // Number of the series, for its colour and marker; dashes have none.
  int index = 0;
};

struct Heading {
  std::string title = {};
  // A smaller line below the title; may be empty.
  std::string subtitle = {};
  std::vector<LegendEntry> legend = {};
};

// Space beside the axes for their labels and titles, in pixels.
struct Margins {
  double left = 140;
  double right = 40;
  double bottom = 100;
};

// Writes the heading; returns the area below it and within the margins.
Box AddHeading(const Heading& heading, GnuplotScript& script,
               const Margins& margins = {});

// Writes a legend whose rows begin at `from` and end before the x of `right`.
// Returns the y below its last row.
double AddLegend(const std::vector<LegendEntry>& legend, Point from,
                 double right, GnuplotScript& script);

}  // namespace tactus::internal::client
