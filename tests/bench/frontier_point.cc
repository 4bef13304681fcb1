#include "tests/bench/frontier_point.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "client/tools/plot/figure.h"
#include "client/tools/plot/pareto.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::client {
namespace {

constexpr Ladder kLadders[] = {Ladder::kClassifier, Ladder::kPrecision,
                               Ladder::kSimulator};

const char* NameOf(Ladder ladder) {
  switch (ladder) {
    case Ladder::kClassifier:
      return "classifier";
    case Ladder::kPrecision:
      return "precision";
    case Ladder::kSimulator:
      return "simulator";
  }
  return "";
}

ScatterPlot EmptyPlot(Ladder ladder) {
  ScatterPlot plot;
  plot.pareto_front = true;
  plot.better_y = Better::kLow;
  plot.x = {.title = "time per contact frame (ns)", .scale = AxisScale::kLog};
  plot.y = {.scale = AxisScale::kLog};
  switch (ladder) {
    case Ladder::kClassifier:
      plot.title = "What a better answer costs";
      plot.y = {.title = "told wrong 1.2 s after onset (%)"};
      break;
    case Ladder::kPrecision:
      plot.title = "What digits of the HMM scores cost";
      plot.x.title = "time per scored frame (ns)";
      plot.y.title = "error of the log-likelihood (nats per scored frame)";
      break;
    case Ladder::kSimulator:
      plot.title = "What digits of the simulator cost";
      plot.x.title = "time per simulated frame (ns)";
      plot.y.title = "error / peak of the feature";
      break;
  }
  return plot;
}

}  // namespace

void MarkFronts(std::vector<FrontierPoint>& points) {
  for (const Ladder ladder : kLadders) {
    std::vector<FrontierPoint*> of_ladder;
    std::vector<ScatterPoint> scatter;
    for (FrontierPoint& point : points) {
      if (point.ladder != ladder) continue;
      point.front = false;
      of_ladder.push_back(&point);
      scatter.push_back({point.nanoseconds, point.Wrong()});
    }
    for (int i : ParetoFront(scatter, Better::kLow, Better::kLow)) {
      of_ladder[i]->front = true;
    }
  }
}

std::string FrontierTable(const std::vector<FrontierPoint>& points) {
  std::string table =
      "ladder,family,variant,ns_per_frame,error,accuracy,final_accuracy,"
      "front\n";
  for (const FrontierPoint& point : points) {
    absl::StrAppendFormat(
        &table, "%s,%s,%s,%.4g,%s,%.4f,%s,%s\n", NameOf(point.ladder),
        point.family, point.variant, point.nanoseconds,
        point.error ? absl::StrFormat("%.3g", *point.error) : "",
        point.accuracy,
        point.final_accuracy ? absl::StrFormat("%.4f", *point.final_accuracy)
                             : "",
        point.front ? "yes" : "no");
  }
  return table;
}

std::vector<BenchRow> FrontierRows(const std::vector<FrontierPoint>& points) {
  std::vector<BenchRow> rows;
  for (const FrontierPoint& point : points) {
    const std::string name =
        absl::AsciiStrToLower(absl::StrCat(point.family, "-", point.variant));
    rows.push_back({.name = absl::StrCat(
                        "frontier/", NameOf(point.ladder), "/",
                        absl::StrReplaceAll(name, {{" ", "-"}, {",", ""}})),
                    .unit = "ns",
                    .ours = point.nanoseconds,
                    .error = point.error,
                    .error_reference = point.error_reference,
                    .accuracy = point.accuracy});
  }
  return rows;
}

absl::Status DrawFrontiers(const std::vector<FrontierPoint>& points,
                           const std::string& folder) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) return IoError(folder, failed.message());
  for (const Ladder ladder : kLadders) {
    ScatterPlot plot = EmptyPlot(ladder);
    for (const FrontierPoint& point : points) {
      if (point.ladder != ladder) continue;
      auto series =
          std::ranges::find(plot.series, point.family, &ScatterSeries::name);
      if (series == plot.series.end()) {
        plot.series.push_back({.name = point.family});
        series = plot.series.end() - 1;
      }
      series->points.push_back(
          {point.nanoseconds, point.Wrong(), point.variant});
    }
    TACTUS_RETURN_IF_ERROR(WritePng(
        plot, absl::StrCat(folder, "/frontier-", NameOf(ladder), ".png")));
  }
  return absl::OkStatus();
}

}  // namespace tactus::client
