#include "tests/bench/work_precision.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace tactus::internal::client {
namespace {

Series& SeriesOf(const std::string& name, LinePlot& plot) {
  const auto found =
      std::find_if(plot.series.begin(), plot.series.end(),
                   [&](const Series& series) { return series.name == name; });
  if (found != plot.series.end()) return *found;
  return plot.series.emplace_back(Series{.name = name});
}

}  // namespace

std::string WorkTable(const std::vector<WorkPoint>& points) {
  std::string table =
      "sample,method,tolerance,seconds,median_error,worst_error\n";
  for (const WorkPoint& point : points) {
    absl::StrAppendFormat(&table, "%s,%s,%g,%.3g,%.3g,%.3g\n", point.sample,
                          point.method, point.tolerance, point.seconds,
                          point.median_error, point.worst_error);
  }
  return table;
}

LinePlot WorkFigure(const std::vector<WorkPoint>& points) {
  LinePlot plot;
  plot.title = "Work and precision of the contact simulator";
  plot.x = {.title = "processor time of one contact (ms)",
            .scale = AxisScale::kLog};
  plot.y = {.title = "error / peak of the feature",
            .scale = AxisScale::kLog,
            .low = 1e-14,
            .high = 10};
  for (const WorkPoint& point : points) {
    const std::string name = absl::StrCat(point.method, ", ", point.sample);
    Series& worst = SeriesOf(absl::StrCat(name, ", worst"), plot);
    worst.x.push_back(1e3 * point.seconds);
    worst.y.push_back(point.worst_error);
    if (point.sample != points.front().sample) continue;
    Series& median = SeriesOf(absl::StrCat(name, ", median"), plot);
    median.x.push_back(1e3 * point.seconds);
    median.y.push_back(point.median_error);
  }
  return plot;
}

}  // namespace tactus::internal::client
