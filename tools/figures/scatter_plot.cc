#include "tools/figures/scatter_plot.h"

#include <algorithm>
#include <functional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "tools/figures/label_places.h"
#include "tools/figures/pareto.h"
#include "tools/figures/sheet.h"

namespace tactus::internal::client {
namespace {

constexpr int kScatterWidth = 1200;
constexpr int kScatterHeight = 860;
// Half of the side of what a marker, with its ring, covers.
constexpr double kMarkerHalf = 14;
// Half of the thickness that a line is given when labels avoid it.
constexpr double kLineHalf = 2;

std::vector<ScatterPoint> AllPoints(const ScatterPlot& plot) {
  std::vector<ScatterPoint> points;
  for (const ScatterSeries& series : plot.series) {
    points.insert(points.end(), series.points.begin(), series.points.end());
  }
  return points;
}

// The staircase between points of the front: none of them promises what lies
// between two of them.
std::vector<ScatterPoint> Staircase(const std::vector<ScatterPoint>& front,
                                    Better better_x) {
  std::vector<ScatterPoint> steps;
  for (size_t i = 0; i < front.size(); ++i) {
    if (i > 0) {
      const ScatterPoint& last = front[i - 1];
      steps.push_back(better_x == Better::kLow
                          ? ScatterPoint{front[i].x, last.y}
                          : ScatterPoint{last.x, front[i].y});
    }
    steps.push_back(front[i]);
  }
  return steps;
}

std::vector<std::vector<double>> RowsOf(
    const std::vector<ScatterPoint>& points) {
  std::vector<std::vector<double>> rows;
  for (const ScatterPoint& point : points) rows.push_back({point.x, point.y});
  return rows;
}

void AddLabels(const std::vector<ScatterPoint>& points,
               const std::vector<ScatterPoint>& stairs, const Box& area,
               const std::function<Point(const ScatterPoint&)>& place,
               GnuplotScript& script) {
  std::vector<Box> occupied;
  std::vector<LabelledPoint> labelled;
  for (const ScatterPoint& point : points) {
    const Point at = place(point);
    occupied.push_back({at.x - kMarkerHalf, at.y - kMarkerHalf,
                        at.x + kMarkerHalf, at.y + kMarkerHalf});
    if (!point.label.empty()) labelled.push_back({at, point.label});
  }
  for (size_t i = 1; i < stairs.size(); ++i) {
    const Point a = place(stairs[i - 1]);
    const Point b = place(stairs[i]);
    occupied.push_back(
        {std::min(a.x, b.x) - kLineHalf, std::min(a.y, b.y) - kLineHalf,
         std::max(a.x, b.x) + kLineHalf, std::max(a.y, b.y) + kLineHalf});
  }
  const std::vector<LabelPlace> places =
      PlaceLabels(labelled, occupied, area, kSmallSize);
  for (size_t i = 0; i < places.size(); ++i) {
    script.Text(labelled[i].label, places[i].at(), {.size = kSmallSize});
    if (!places[i].leader) continue;
    script.Line(places[i].leader->from, places[i].leader->to,
                absl::StrFormat("lc rgb '%s' lw 1.5", kSoftInk));
  }
}

}  // namespace

absl::StatusOr<GnuplotScript> ScriptOf(const ScatterPlot& plot) {
  if (plot.series.empty() || plot.series.size() > kMaxSeries) {
    return InvalidConfig("series of a plot", plot.series.size(),
                         absl::StrCat("1 to ", kMaxSeries));
  }
  const std::vector<ScatterPoint> points = AllPoints(plot);
  std::vector<double> all_x;
  std::vector<double> all_y;
  for (const ScatterPoint& point : points) {
    all_x.push_back(point.x);
    all_y.push_back(point.y);
  }
  TACTUS_RETURN_IF_ERROR(CheckValues(plot.x, all_x));
  TACTUS_RETURN_IF_ERROR(CheckValues(plot.y, all_y));
  Heading heading = {.title = plot.title, .subtitle = plot.subtitle};
  for (const ScatterSeries& series : plot.series) {
    heading.legend.push_back(
        {.name = series.name,
         .sample = LegendSample::kMarker,
         .index = static_cast<int>(heading.legend.size())});
  }
  std::vector<ScatterPoint> front;
  if (plot.pareto_front) {
    heading.legend.push_back(
        {.name = "Pareto front", .sample = LegendSample::kDashes});
    for (const int i : ParetoFront(points, plot.better_x, plot.better_y)) {
      front.push_back(points[i]);
    }
  }
  const std::vector<ScatterPoint> stairs = Staircase(front, plot.better_x);

  GnuplotScript script(kScatterWidth, kScatterHeight);
  const Box area = AddHeading(heading, script);
  const Range x = RangeShown(plot.x, all_x);
  const Range y = RangeShown(plot.y, all_y);
  AddLabels(
      points, stairs, area,
      [&](const ScatterPoint& point) {
        return Point{area.left + area.width() * PlaceOn(plot.x, x, point.x),
                     area.bottom - area.height() * PlaceOn(plot.y, y, point.y)};
      },
      script);
  std::vector<std::string> curves;
  if (plot.pareto_front) {
    script.Data("stairs", RowsOf(stairs));
    script.Data("front", RowsOf(front));
    curves.push_back(absl::StrFormat("$stairs with lines lc rgb '%s' %s",
                                     kSoftInk, kDashes));
    // Each ring is white inside: the stairs end at it.
    curves.push_back("$front with points lc rgb '#ffffff' pt 7 ps 4.2");
    curves.push_back(absl::StrFormat(
        "$front with points lc rgb '%s' lw 2.5 pt 6 ps 4.2", kSoftInk));
  }
  for (size_t i = 0; i < plot.series.size(); ++i) {
    script.Data(absl::StrCat("series", i), RowsOf(plot.series[i].points));
    const int index = static_cast<int>(i);
    curves.push_back(
        absl::StrFormat("$series%d with points lc rgb '%s' pt %d ps 2.6", index,
                        SeriesColour(index), SeriesMarker(index)));
  }
  script.PlotArea(area);
  SetAxis('x', plot.x, x, script);
  SetAxis('y', plot.y, y, script);
  script.Add("plot %s", absl::StrJoin(curves, ", \\\n  "));
  return script;
}

}  // namespace tactus::internal::client
