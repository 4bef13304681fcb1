#include <algorithm>

#include "absl/strings/str_cat.h"
#include "client/tools/plot/draw.h"
#include "client/tools/plot/frame.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::client {
namespace {

constexpr double kWidth = 560;
constexpr double kHeight = 390;

absl::Status Check(const LinePlot& plot) {
  TACTUS_RETURN_IF_ERROR(CheckSeriesCount(plot.series.size()));
  for (const Series& series : plot.series) {
    if (series.x.size() != series.y.size()) {
      return InvalidConfig(
          absl::StrCat("series \"", series.name, "\""),
          absl::StrCat(series.x.size(), " x, ", series.y.size(), " y"),
          "as many x as y");
    }
  }
  return absl::OkStatus();
}

std::vector<LegendEntry> Legend(const LinePlot& plot) {
  using Kind = LegendEntry::Kind;
  std::vector<LegendEntry> legend;
  for (const Series& series : plot.series) {
    legend.push_back(
        {.name = series.name,
         .kind = series.markers ? Kind::kLineWithMarker : Kind::kLine,
         .index = static_cast<int>(legend.size())});
  }
  for (size_t i = 0; i < plot.references.size(); ++i) {
    legend.push_back({.name = plot.references[i].name,
                      .kind = Kind::kDashed,
                      .index = static_cast<int>(i)});
  }
  // One unnamed line needs no legend.
  if (legend.size() == 1 && legend[0].name.empty()) legend.clear();
  return legend;
}

// y = x from one side of the plot to another.
void DrawDiagonal(const PlotFrame& frame, Canvas& canvas) {
  const double low = std::max(frame.x().low, frame.y().low);
  const double high = std::min(frame.x().high, frame.y().high);
  if (low >= high) return;
  canvas.Line(frame.At(low, low), frame.At(high, high), {170, 170, 170}, 1.2);
}

}  // namespace

absl::StatusOr<Canvas> Draw(const LinePlot& plot) {
  TACTUS_RETURN_IF_ERROR(Check(plot));
  std::vector<double> all_x;
  std::vector<double> all_y;
  for (const Series& series : plot.series) {
    all_x.insert(all_x.end(), series.x.begin(), series.x.end());
    all_y.insert(all_y.end(), series.y.begin(), series.y.end());
  }
  for (const ReferenceLine& line : plot.references) all_y.push_back(line.y);
  TACTUS_ASSIGN_OR_RETURN(const DataRange range_x, RangeOf(all_x, "x"));
  TACTUS_ASSIGN_OR_RETURN(const DataRange range_y, RangeOf(all_y, "y"));

  FrameSpec spec = {.title = plot.title,
                    .x_title = plot.x.title,
                    .y_title = plot.y.title,
                    .legend = Legend(plot)};
  TACTUS_ASSIGN_OR_RETURN(spec.x, MakeScale(plot.x, range_x, 7));
  TACTUS_ASSIGN_OR_RETURN(spec.y, MakeScale(plot.y, range_y, 6));
  Canvas canvas(kWidth, kHeight);
  const PlotFrame frame(canvas, kWidth, kHeight, spec);
  if (plot.diagonal) DrawDiagonal(frame, canvas);
  for (size_t i = 0; i < plot.references.size(); ++i) {
    frame.DrawReference(canvas, static_cast<int>(i), plot.references[i].y);
  }
  // All lines first: no line hides a marker.
  std::vector<std::vector<Point>> lines;
  for (const Series& series : plot.series) {
    std::vector<Point>& points = lines.emplace_back();
    for (size_t k = 0; k < series.x.size(); ++k) {
      points.push_back(frame.At(series.x[k], series.y[k]));
    }
    canvas.Polyline(points, SeriesColour(static_cast<int>(lines.size()) - 1),
                    1.8);
  }
  for (size_t i = 0; i < lines.size(); ++i) {
    if (!plot.series[i].markers) continue;
    const int index = static_cast<int>(i);
    for (Point point : lines[i]) {
      canvas.Marker(index, point, 7, SeriesColour(index));
    }
  }
  return canvas;
}

}  // namespace tactus::client
