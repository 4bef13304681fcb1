#include "tests/bench/frontier.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <system_error>
#include <utility>

#include "CLI/CLI.hpp"
#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/frontier_models.h"
#include "tools/figures/figure.h"
#include "tools/figures/pareto.h"

namespace tactus::internal::client {
namespace {

constexpr Comparison kComparisons[] = {
    Comparison::kClassifier, Comparison::kPrecision, Comparison::kSimulator};

const char* NameOf(Comparison comparison) {
  switch (comparison) {
    case Comparison::kClassifier:
      return "classifier";
    case Comparison::kPrecision:
      return "precision";
    case Comparison::kSimulator:
      return "simulator";
  }
  return "";
}

ScatterPlot EmptyPlot(Comparison comparison) {
  ScatterPlot plot;
  plot.pareto_front = true;
  plot.better_y = Better::kLow;
  plot.x = {.title = "time per contact frame (ns)", .scale = AxisScale::kLog};
  plot.y = {.scale = AxisScale::kLog};
  switch (comparison) {
    case Comparison::kClassifier:
      plot.title = "What a better answer costs";
      plot.y = {.title = "wrong 1.2 s after onset (%)"};
      break;
    case Comparison::kPrecision:
      plot.title = "What digits of the HMM scores cost";
      plot.x.title = "time per scored frame (ns)";
      plot.y.title = "error of the log-likelihood (nats per scored frame)";
      break;
    case Comparison::kSimulator:
      plot.title = "What digits of the simulator cost";
      plot.x.title = "time per simulated frame (ns)";
      plot.y.title = "error / peak of the feature";
      break;
  }
  return plot;
}

}  // namespace

void MarkFronts(std::vector<FrontierPoint>& points) {
  for (const Comparison comparison : kComparisons) {
    std::vector<FrontierPoint*> compared;
    std::vector<ScatterPoint> scatter;
    for (FrontierPoint& point : points) {
      if (point.comparison != comparison) continue;
      point.front = false;
      compared.push_back(&point);
      scatter.push_back({point.nanoseconds, point.Wrong()});
    }
    for (int i : ParetoFront(scatter, Better::kLow, Better::kLow)) {
      compared[i]->front = true;
    }
  }
}

std::string FrontierTable(const std::vector<FrontierPoint>& points) {
  std::string table =
      "comparison,family,variant,ns_per_frame,error,contacts,accuracy,"
      "final_accuracy,front\n";
  for (const FrontierPoint& point : points) {
    absl::StrAppendFormat(
        &table, "%s,%s,%s,%.4g,%s,%d,%.6f,%s,%s\n", NameOf(point.comparison),
        point.family, point.variant, point.nanoseconds,
        point.error ? absl::StrFormat("%.3g", *point.error) : "",
        point.contacts, point.accuracy,
        point.final_accuracy ? absl::StrFormat("%.6f", *point.final_accuracy)
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
                        "frontier/", NameOf(point.comparison), "/",
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
  for (const Comparison comparison : kComparisons) {
    ScatterPlot plot = EmptyPlot(comparison);
    for (const FrontierPoint& point : points) {
      if (point.comparison != comparison) continue;
      auto series =
          std::ranges::find(plot.series, point.family, &ScatterSeries::name);
      if (series == plot.series.end()) {
        plot.series.push_back({.name = point.family});
        series = plot.series.end() - 1;
      }
      series->points.push_back(
          {point.nanoseconds, point.Wrong(), point.variant});
    }
    TACTUS_RETURN_IF_ERROR(DrawFigure(
        plot, absl::StrCat(folder, "/frontier-", NameOf(comparison), ".png")));
  }
  return absl::OkStatus();
}

namespace {

absl::StatusOr<std::vector<FrontierPoint>> MeasureFrontier(bool quick) {
  TACTUS_ASSIGN_OR_RETURN(const FrontierContacts contacts,
                          SimulateContacts(quick));
  TACTUS_ASSIGN_OR_RETURN(MeasuredClassifiers classifiers,
                          MeasureClassifiers(contacts, quick));
  std::vector<FrontierPoint> points = std::move(classifiers.points);
  const auto append = [&points](std::vector<FrontierPoint> more) {
    std::move(more.begin(), more.end(), std::back_inserter(points));
  };
  TACTUS_ASSIGN_OR_RETURN(
      auto precision,
      MeasurePrecision(classifiers.tuned->model(), contacts.test, quick));
  append(std::move(precision));
  TACTUS_ASSIGN_OR_RETURN(auto simulators,
                          MeasureSimulators(classifiers.tuned, quick));
  append(std::move(simulators));
  MarkFronts(points);
  return points;
}

class FrontierBenchmark : public Benchmark {
 public:
  const char* name() const override { return "frontier"; }
  const char* description() const override {
    return "Run time against error, of classifiers, precisions, simulators";
  }

  void AddFlags(CLI::App& command) override {
    command.add_option("--table", table_, "Write the table as CSV");
    command.add_option("--figures", figures_,
                       "Folder to draw one picture per comparison into");
  }

  absl::StatusOr<std::vector<BenchRow>> Run(bool quick) override {
    TACTUS_ASSIGN_OR_RETURN(const std::vector<FrontierPoint> points,
                            MeasureFrontier(quick));
    if (!table_.empty()) {
      std::ofstream file(table_);
      file << FrontierTable(points);
      if (!file.flush()) return IoError(table_, "cannot be written");
    }
    if (!figures_.empty()) {
      TACTUS_RETURN_IF_ERROR(DrawFrontiers(points, figures_));
    }
    return FrontierRows(points);
  }

 private:
  std::string table_;
  std::string figures_;
};

}  // namespace

std::unique_ptr<Benchmark> MakeFrontierBenchmark() {
  return std::make_unique<FrontierBenchmark>();
}

}  // namespace tactus::internal::client
