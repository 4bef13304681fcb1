// File: figure.h
//
// Every chart of the tools, drawn by gnuplot with one call.
//
//   TACTUS_RETURN_IF_ERROR(DrawFigure(plot, "anytime.png"));
//
// A chart is plain data (line_plot.h, scatter_plot.h, bar_chart.h,
// confusion_matrix.h). Charts are white, in colours that colour-blind readers
// tell apart, and sized to be shown at half their pixels. Titles name the
// quantity, axes name the unit.
//
// Free functions without state; thread-safe. The same chart gives the same
// script.
#pragma once

#include <string>
#include <variant>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "tools/figures/bar_chart.h"
#include "tools/figures/confusion_matrix.h"
#include "tools/figures/line_plot.h"
#include "tools/figures/scatter_plot.h"

namespace tactus::internal::client {

using Figure = std::variant<LinePlot, ScatterPlot, BarChart, ConfusionMatrix>;

// The chart as the bytes of a PNG file. INVALID_CONFIG names what cannot be
// drawn; IO if gnuplot is not installed.
absl::StatusOr<std::string> FigureAsPng(const Figure& figure);

// Writes the chart as a PNG file. INVALID_CONFIG names what cannot be drawn; IO
// if gnuplot is not installed or `path` cannot be written.
absl::Status DrawFigure(const Figure& figure, const std::string& path);

}  // namespace tactus::internal::client
