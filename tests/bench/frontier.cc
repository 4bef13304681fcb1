#include "tests/bench/frontier.h"

#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "CLI/CLI.hpp"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "tests/bench/frontier_classifier.h"
#include "tests/bench/frontier_data.h"
#include "tests/bench/frontier_point.h"
#include "tests/bench/frontier_precision.h"
#include "tests/bench/frontier_sim.h"

namespace tactus::client {
namespace {

absl::StatusOr<std::vector<FrontierPoint>> MeasureFrontier(bool quick) {
  TACTUS_ASSIGN_OR_RETURN(const FrontierData data, MakeFrontierData(quick));
  TACTUS_ASSIGN_OR_RETURN(ClassifierLadder classifiers,
                          MeasureClassifiers(data, quick));
  std::vector<FrontierPoint> points = std::move(classifiers.points);
  const auto append = [&points](std::vector<FrontierPoint> more) {
    std::move(more.begin(), more.end(), std::back_inserter(points));
  };
  TACTUS_ASSIGN_OR_RETURN(
      auto precision,
      MeasurePrecision(classifiers.served->model(), data.test, quick));
  append(std::move(precision));
  TACTUS_ASSIGN_OR_RETURN(auto simulators,
                          MeasureSimulators(classifiers.served, quick));
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
                       "Folder to draw a picture of each ladder into");
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

}  // namespace tactus::client
