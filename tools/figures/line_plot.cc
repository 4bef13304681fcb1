#include "tools/figures/line_plot.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "tools/figures/sheet.h"

namespace tactus::internal::client {
namespace {

constexpr int kLineWidth = 1120;
constexpr int kLineHeight = 800;
// Height of the counts below the plot, and the gap between the two.
constexpr double kCountHeight = 150;
constexpr double kCountGap = 36;

void Append(const std::vector<double>& more, std::vector<double>& values) {
  values.insert(values.end(), more.begin(), more.end());
}

absl::Status Check(const LinePlot& plot) {
  if (plot.series.empty() || plot.series.size() > kMaxSeries) {
    return InvalidConfig("series of a plot", plot.series.size(),
                         absl::StrCat("1 to ", kMaxSeries));
  }
  for (const Series& series : plot.series) {
    const size_t length = series.x.size();
    const size_t intervals = series.low.size();
    if (series.y.size() != length || series.high.size() != intervals ||
        (intervals != 0 && intervals != length) ||
        (!series.few.empty() && series.few.size() != length)) {
      return InvalidConfig(series.name, "lengths that differ",
                           "x, y, low, high and few of one length");
    }
  }
  if (!plot.counts.counts.empty() &&
      plot.counts.edges.size() != plot.counts.counts.size() + 1) {
    return InvalidConfig(plot.counts.title, plot.counts.edges.size(),
                         "one edge more than counts");
  }
  return absl::OkStatus();
}

std::vector<std::vector<double>> RowsOf(const Series& series) {
  std::vector<std::vector<double>> rows;
  for (size_t i = 0; i < series.x.size(); ++i) {
    rows.push_back({series.x[i], series.y[i]});
    if (!series.low.empty()) {
      rows.back().insert(rows.back().end(), {series.low[i], series.high[i]});
    }
  }
  return rows;
}

bool HasFew(const Series& series) {
  return std::ranges::find(series.few, true) != series.few.end();
}

// Defines the data of series i: all its points; if some stand for few
// observations, also those, and the others as lines with gaps between them.
void AddData(const Series& series, int i, GnuplotScript& script) {
  const std::vector<std::vector<double>> rows = RowsOf(series);
  script.Data(absl::StrCat("series", i), rows);
  if (!HasFew(series)) return;
  std::vector<std::vector<double>> few;
  std::vector<std::vector<double>> many;
  for (size_t k = 0; k < rows.size(); ++k) {
    // gnuplot interrupts a line at a row without numbers.
    if (series.few[k]) many.emplace_back();
    (series.few[k] ? few : many).push_back(rows[k]);
  }
  script.Data(absl::StrCat("few", i), few);
  script.Data(absl::StrCat("many", i), many);
}

// Line and markers of series i, of those whose last is `last`.
void AppendPoints(const Series& series, int i, int last,
                  std::vector<std::string>& curves) {
  const double depth = i / std::max(2., static_cast<double>(last));
  const char* colour = SeriesColour(i);
  const double size = 2.1 + 0.8 * depth;
  const bool few = HasFew(series);
  if (few) {
    // White inside, so that the interval does not show through.
    curves.push_back(absl::StrFormat(
        "$few%d using 1:2 with points lc rgb '#ffffff' pt %d ps %g", i,
        SeriesMarker(i), size));
    curves.push_back(absl::StrFormat(
        "$few%d using 1:2 with points lc rgb '%s' lw 3 pt %d ps %g", i, colour,
        HollowMarker(i), size));
    // A block without numbers is an error to gnuplot.
    if (std::ranges::find(series.few, false) == series.few.end()) return;
  }
  std::string curve = absl::StrFormat(
      "$%s%d using 1:2 with %s lc rgb '%s' lw %g", few ? "many" : "series", i,
      series.markers ? "linespoints" : "lines", colour, 4 + 3.2 * depth);
  if (series.markers) {
    absl::StrAppendFormat(&curve, " pt %d ps %g", SeriesMarker(i), size);
  }
  curves.push_back(std::move(curve));
}

// Arguments of gnuplot's `plot`, lowest first: intervals, reference lines, then
// the series from the last to the first. Lower lines are thicker, so that they
// still show where lines coincide.
std::string Curves(const LinePlot& plot) {
  std::vector<std::string> curves;
  for (size_t i = 0; i < plot.series.size(); ++i) {
    const Series& series = plot.series[i];
    const char* colour = SeriesColour(static_cast<int>(i));
    if (series.low.empty()) continue;
    if (series.interval == IntervalStyle::kBand) {
      curves.push_back(
          absl::StrFormat("$series%d using 1:3:4 with filledcurves lc rgb '%s' "
                          "fs transparent solid 0.16 noborder",
                          i, colour));
    } else {
      curves.push_back(absl::StrFormat("$series%d %s lc rgb '%s' lw 3", i,
                                       kIntervalBars, colour));
    }
  }
  for (const ReferenceLine& line : plot.references) {
    curves.push_back(absl::StrFormat("%.9g with lines lc rgb '%s' %s", line.y,
                                     kSoftInk, kDashes));
  }
  if (!plot.diagonal.empty()) {
    curves.push_back(
        absl::StrFormat("x with lines lc rgb '%s' %s", kSoftInk, kDashes));
  }
  const int last = static_cast<int>(plot.series.size()) - 1;
  for (int i = last; i >= 0; --i) {
    AppendPoints(plot.series[i], i, last, curves);
  }
  return absl::StrJoin(curves, ", \\\n  ");
}

void AddCounts(const LinePlot& plot, const Range& x, const Box& area,
               GnuplotScript& script) {
  const CountBars& bars = plot.counts;
  const int most = std::ranges::max(bars.counts);
  const Axis y = {.title = bars.title, .scale = AxisScale::kLog};
  // Nothing is 0.5 high: the axis is logarithmic. Above the highest bar is room
  // for its number.
  const Range range = {0.5, 5. * std::max(1, most)};
  std::vector<std::vector<double>> rows;
  for (size_t i = 0; i < bars.counts.size(); ++i) {
    const double left = bars.edges[i];
    const double right = bars.edges[i + 1];
    rows.push_back({(left + right) / 2, std::max(0.5, 1. * bars.counts[i]),
                    0.9 * (right - left)});
    if (bars.counts[i] == 0) continue;
    const double place = PlaceOn(plot.x, x, (left + right) / 2);
    if (place < 0 || place > 1) continue;
    script.Text(
        absl::StrCat(bars.counts[i]),
        {area.left + place * area.width(),
         area.bottom - PlaceOn(y, range, bars.counts[i]) * area.height() - 13},
        {.size = kSmallSize, .colour = kSoftInk, .align = Align::kCentre});
  }
  script.Data("counts", rows);
  script.PlotArea(area);
  SetAxis('x', plot.x, x, script);
  SetAxis('y', y, range, script);
  script.Add("set ytics (1, 10, 100, 1000, 10000, 100000)");
  // Lines would cross the numbers.
  script.Add("set grid noytics");
  script.Add("plot $counts using 1:2:3 with boxes lc rgb '%s' ", "#b5b5b5");
}

}  // namespace

absl::StatusOr<GnuplotScript> ScriptOf(const LinePlot& plot) {
  TACTUS_RETURN_IF_ERROR(Check(plot));
  std::vector<double> all_x;
  std::vector<double> all_y;
  Heading heading = {.title = plot.title, .subtitle = plot.subtitle};
  for (const Series& series : plot.series) {
    Append(series.x, all_x);
    Append(series.y, all_y);
    Append(series.low, all_y);
    Append(series.high, all_y);
    heading.legend.push_back(
        {.name = series.name,
         .sample = series.markers ? LegendSample::kLineAndMarker
                                  : LegendSample::kLine,
         .index = static_cast<int>(heading.legend.size())});
  }
  const auto few = std::ranges::find_if(plot.series, HasFew);
  if (few != plot.series.end()) {
    heading.legend.push_back(
        {.name = plot.few_name,
         .sample = LegendSample::kHollowMarker,
         .index = static_cast<int>(few - plot.series.begin())});
  }
  for (const ReferenceLine& line : plot.references) {
    all_y.push_back(line.y);
    heading.legend.push_back(
        {.name = line.name, .sample = LegendSample::kDashes});
  }
  if (!plot.diagonal.empty()) {
    heading.legend.push_back(
        {.name = plot.diagonal, .sample = LegendSample::kDashes});
  }
  TACTUS_RETURN_IF_ERROR(CheckValues(plot.x, all_x));
  TACTUS_RETURN_IF_ERROR(CheckValues(plot.y, all_y));

  const bool with_counts = !plot.counts.counts.empty();
  const double below = with_counts ? kCountHeight + kCountGap : 0;
  GnuplotScript script(kLineWidth, kLineHeight + static_cast<int>(below));
  Box area = AddHeading(heading, script);
  const Box count_area = {area.left, area.bottom - kCountHeight, area.right,
                          area.bottom};
  area.bottom -= below;
  const Range x = RangeShown(plot.x, all_x);
  for (size_t i = 0; i < plot.series.size(); ++i) {
    AddData(plot.series[i], static_cast<int>(i), script);
  }
  if (with_counts) script.Add("set multiplot");
  script.PlotArea(area);
  SetAxis('x', plot.x, x, script);
  SetAxis('y', plot.y, RangeShown(plot.y, all_y), script);
  if (with_counts) {
    // The labels stand below the counts.
    script.Add("set format x ''");
    script.Add("unset xlabel");
  }
  script.Add("plot %s", Curves(plot));
  if (with_counts) {
    script.ClearText();
    AddCounts(plot, x, count_area, script);
    script.Add("unset multiplot");
  }
  return script;
}

}  // namespace tactus::internal::client
