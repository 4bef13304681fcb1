#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "client/tools/plot/draw.h"
#include "client/tools/plot/frame.h"
#include "client/tools/plot/pareto.h"
#include "core/base/status_macros.h"

namespace tactus::client {
namespace {

constexpr double kWidth = 560;
constexpr double kHeight = 410;
constexpr double kMarkerSize = 8;
constexpr double kRingRadius = 7.4;
constexpr TextStyle kLabelStyle = {.size = 9.5};

std::vector<LegendEntry> Legend(const ScatterPlot& plot) {
  std::vector<LegendEntry> legend;
  for (const ScatterSeries& series : plot.series) {
    legend.push_back({.name = series.name,
                      .kind = LegendEntry::Kind::kMarker,
                      .index = static_cast<int>(legend.size())});
  }
  if (plot.pareto_front) {
    legend.push_back(
        {.name = "Pareto front", .kind = LegendEntry::Kind::kDashed});
  }
  if (legend.size() == 1 && legend[0].name.empty()) legend.clear();
  return legend;
}

std::vector<ScatterPoint> AllPoints(const ScatterPlot& plot) {
  std::vector<ScatterPoint> points;
  for (const ScatterSeries& series : plot.series) {
    points.insert(points.end(), series.points.begin(), series.points.end());
  }
  return points;
}

double Area(const Box& a, const Box& b) {
  const double width = std::min(a.right, b.right) - std::max(a.left, b.left);
  const double height = std::min(a.bottom, b.bottom) - std::max(a.top, b.top);
  return width > 0 && height > 0 ? width * height : 0;
}

// Where a label may stand, and what the place costs beside what it covers, as a
// share of the label: near the point is better, and needs no leader.
struct Place {
  Box box;
  double penalty = 0;
  bool leader = false;
};

// Beside, above and below the point, then ever further up and down.
std::vector<Place> Places(Point point, double width) {
  constexpr int kFurthest = 6;
  constexpr double kPenalty = 0.05;
  const double gap = kRingRadius + 2.5;
  const double half = kLabelStyle.size / 2 + 0.5;
  std::vector<Place> places;
  const auto add = [&](int side, double shift, int distance) {
    const double left = side > 0   ? point.x + gap
                        : side < 0 ? point.x - gap - width
                                   : point.x - width / 2;
    const double middle = point.y + shift;
    places.push_back({.box = {left, middle - half, left + width, middle + half},
                      .penalty = kPenalty * distance,
                      .leader = distance > 1});
  };
  add(1, 0, 0);
  add(-1, 0, 0);
  for (int distance = 1; distance <= kFurthest; ++distance) {
    const double beyond = (distance - 1) * (2 * half + 2);
    for (int up : {-1, 1}) {
      add(0, up * (gap + half + beyond), distance);
      for (int side : {1, -1}) add(side, up * (half + 2 + beyond), distance);
    }
  }
  return places;
}

// Lines of the front between its points, in steps: no point of it promises
// what lies between two of them.
std::vector<std::pair<Point, Point>> FrontLines(
    const std::vector<ScatterPoint>& points, const std::vector<int>& front,
    Better better_x, const PlotFrame& frame) {
  std::vector<std::pair<Point, Point>> lines;
  for (size_t i = 1; i < front.size(); ++i) {
    const ScatterPoint& a = points[front[i - 1]];
    const ScatterPoint& b = points[front[i]];
    const Point corner =
        better_x == Better::kLow ? frame.At(b.x, a.y) : frame.At(a.x, b.y);
    lines.push_back({frame.At(a.x, a.y), corner});
    lines.push_back({corner, frame.At(b.x, b.y)});
  }
  return lines;
}

// Each label where it covers the least of `taken` and of what is not plot, in
// the order of the points; a thin line leads to one that stands apart.
void DrawLabels(const std::vector<ScatterPoint>& points, std::vector<Box> taken,
                const PlotFrame& frame, Canvas& canvas) {
  for (const ScatterPoint& point : points) {
    if (point.label.empty()) continue;
    const Point at = frame.At(point.x, point.y);
    const double width = Canvas::TextWidth(point.label, kLabelStyle);
    double least = std::numeric_limits<double>::infinity();
    Place best;
    for (const Place& place : Places(at, width)) {
      const Box& box = place.box;
      const double size = box.width() * box.height();
      double cost = size * (1 + place.penalty) - Area(box, frame.plot());
      for (const Box& other : taken) cost += 3 * Area(box, other);
      if (cost < least) {
        least = cost;
        best = place;
      }
    }
    const Box& box = best.box;
    taken.push_back(box);
    if (best.leader) {
      const double end = box.top > at.y ? box.top : box.bottom;
      const double start = at.y + (box.top > at.y ? 1 : -1) * kMarkerSize / 2;
      canvas.Line({at.x, start},
                  {std::clamp(at.x, box.left + 4, box.right - 4), end},
                  kSoftInk, 0.7);
    }
    canvas.Text(point.label, {box.left, (box.top + box.bottom) / 2},
                kLabelStyle);
  }
}

// Draws the front; returns what it takes up.
std::vector<Box> DrawFront(const ScatterPlot& plot,
                           const std::vector<ScatterPoint>& points,
                           const PlotFrame& frame, Canvas& canvas) {
  const std::vector<int> front =
      ParetoFront(points, plot.better_x, plot.better_y);
  std::vector<Box> taken;
  for (const auto& [a, b] : FrontLines(points, front, plot.better_x, frame)) {
    canvas.DashedLine(a, b, kSoftInk, 1.3, 5.5, 5);
    taken.push_back({std::min(a.x, b.x) - 1, std::min(a.y, b.y) - 1,
                     std::max(a.x, b.x) + 1, std::max(a.y, b.y) + 1});
  }
  for (int i : front) {
    const Point at = frame.At(points[i].x, points[i].y);
    canvas.FillCircle(at, kRingRadius, kSoftInk);
    canvas.FillCircle(at, kRingRadius - 1.2, kWhite);
  }
  return taken;
}

// Room around the outermost points, unless an end was given.
Axis Padded(Axis axis, const DataRange& data) {
  constexpr double kShare = 0.04;
  if (data.high <= data.low) return axis;
  if (axis.scale == AxisScale::kLog) {
    if (data.low <= 0) return axis;
    const double factor = std::pow(data.high / data.low, kShare);
    if (!axis.low) axis.low = data.low / factor;
    if (!axis.high) axis.high = data.high * factor;
    return axis;
  }
  const double margin = kShare * (data.high - data.low);
  if (!axis.low) axis.low = data.low - margin;
  if (!axis.high) axis.high = data.high + margin;
  return axis;
}

}  // namespace

absl::StatusOr<Canvas> Draw(const ScatterPlot& plot) {
  TACTUS_RETURN_IF_ERROR(CheckSeriesCount(plot.series.size()));
  const std::vector<ScatterPoint> points = AllPoints(plot);
  std::vector<double> all_x;
  std::vector<double> all_y;
  for (const ScatterPoint& point : points) {
    all_x.push_back(point.x);
    all_y.push_back(point.y);
  }
  TACTUS_ASSIGN_OR_RETURN(const DataRange range_x, RangeOf(all_x, "x"));
  TACTUS_ASSIGN_OR_RETURN(const DataRange range_y, RangeOf(all_y, "y"));
  FrameSpec spec = {.title = plot.title,
                    .x_title = plot.x.title,
                    .y_title = plot.y.title,
                    .legend = Legend(plot)};
  TACTUS_ASSIGN_OR_RETURN(spec.x,
                          MakeScale(Padded(plot.x, range_x), range_x, 7));
  TACTUS_ASSIGN_OR_RETURN(spec.y,
                          MakeScale(Padded(plot.y, range_y), range_y, 6));
  Canvas canvas(kWidth, kHeight);
  const PlotFrame frame(canvas, kWidth, kHeight, spec);
  std::vector<Box> taken;
  if (plot.pareto_front) taken = DrawFront(plot, points, frame, canvas);
  for (size_t i = 0; i < plot.series.size(); ++i) {
    const int index = static_cast<int>(i);
    for (const ScatterPoint& point : plot.series[i].points) {
      const Point at = frame.At(point.x, point.y);
      canvas.Marker(index, at, kMarkerSize, SeriesColour(index));
      const double half = kMarkerSize / 2 + 1;
      taken.push_back({at.x - half, at.y - half, at.x + half, at.y + half});
    }
  }
  DrawLabels(points, std::move(taken), frame, canvas);
  return canvas;
}

}  // namespace tactus::client
