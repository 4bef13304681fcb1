#include "client/bench/work_precision.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace tactus::client {
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
  std::string table = "method,tolerance,seconds,median_error,worst_error\n";
  for (const WorkPoint& point : points) {
    absl::StrAppendFormat(&table, "%s,%g,%.6g,%.3g,%.3g\n", point.method,
                          point.tolerance, point.seconds, point.median_error,
                          point.worst_error);
  }
  return table;
}

LinePlot WorkFigure(const std::vector<WorkPoint>& points) {
  LinePlot plot;
  plot.title = "Work and precision of the contact simulator";
  plot.x = {.title = "processor time of the sample (s)",
            .scale = AxisScale::kLog};
  plot.y = {.title = "error / peak of the feature", .scale = AxisScale::kLog};
  for (const WorkPoint& point : points) {
    Series& worst = SeriesOf(absl::StrCat(point.method, ", worst"), plot);
    worst.x.push_back(point.seconds);
    worst.y.push_back(point.worst_error);
  }
  for (const WorkPoint& point : points) {
    Series& median = SeriesOf(absl::StrCat(point.method, ", median"), plot);
    median.x.push_back(point.seconds);
    median.y.push_back(point.median_error);
  }
  return plot;
}

}  // namespace tactus::client
