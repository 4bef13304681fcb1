// Processor time and peak memory of `trainctl fit` as the trials become more.
// Each fit runs in a new process. The kernel counts the peak memory of a
// process from its start, so a second fit in it would show the peak of both.
#include <sys/resource.h>

#include <fstream>
#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/child_server.h"
#include "tests/bench/temporary_folder.h"
#include "tools/figures/figure.h"

namespace tactus::internal::client {
namespace {

struct FitCost {
  int trials = 0;
  double cpu_seconds = 0;
  double peak_mb = 0;
};

class FitScaleBenchmark : public Benchmark {
 public:
  const char* name() const override { return "fit-scale"; }
  const char* description() const override {
    return "Processor time and peak memory of a fit against its trials";
  }

  void AddFlags(CLI::App& command) override {
    command
        .add_option("--trials", trials_, "Numbers of trials, like 1000,4000")
        ->delimiter(',')
        ->check(CLI::Range(100, 10'000'000))
        ->capture_default_str();
    command.add_option("--table", table_, "Write a Markdown table");
    command.add_option("--figure", figure_, "Write the picture as PNG");
  }

  absl::StatusOr<std::vector<BenchRow>> Run(bool quick) override {
    TACTUS_ASSIGN_OR_RETURN(const TemporaryFolder folder,
                            TemporaryFolder::Create());
    std::vector<FitCost> costs;
    std::vector<BenchRow> rows;
    for (const int trials : quick ? std::vector<int>{200} : trials_) {
      TACTUS_ASSIGN_OR_RETURN(costs.emplace_back(),
                              Fit(trials, folder.path() + "/bundle.tactus"));
      const std::string row = absl::StrCat(name(), "/", trials);
      rows.push_back({.name = row + "/time",
                      .unit = "s",
                      .ours = costs.back().cpu_seconds});
      rows.push_back({.name = row + "/memory",
                      .unit = "MB",
                      .ours = costs.back().peak_mb});
    }
    if (!table_.empty()) TACTUS_RETURN_IF_ERROR(WriteTable(costs));
    if (!figure_.empty()) TACTUS_RETURN_IF_ERROR(Draw(costs));
    return rows;
  }

 private:
  static absl::StatusOr<FitCost> Fit(int trials, const std::string& bundle) {
    TACTUS_ASSIGN_OR_RETURN(
        const pid_t fit,
        SpawnBeside(
            "trainctl",
            {"fit",
             absl::StrCat("--data=world:skin=ideal,contacts=", trials,
                          ",seed=7"),
             "--preset=tuned", "--networks=1", "--no-estimates", "--epochs=2",
             "--hmms-per-class=5", "--skip-unusable", "--out=" + bundle},
            ChildOutput::kErrors));
    rusage used = {};
    TACTUS_RETURN_IF_ERROR(
        AwaitSuccess(fit, absl::StrCat("the fit of ", trials), &used));
    const auto seconds = [](const timeval& time) {
      return static_cast<double>(time.tv_sec) +
             1e-6 * static_cast<double>(time.tv_usec);
    };
    return FitCost{
        .trials = trials,
        .cpu_seconds = seconds(used.ru_utime) + seconds(used.ru_stime),
        .peak_mb = static_cast<double>(used.ru_maxrss) * 1024 / 1e6};
  }

  absl::Status WriteTable(const std::vector<FitCost>& costs) const {
    std::ofstream out(table_);
    out << "| trials | processor time, s | ms a trial | peak memory, MB |\n"
        << "|---|---|---|---|\n";
    for (const FitCost& cost : costs) {
      out << absl::StrFormat(
          "| %d | %.1f | %.1f | %.0f |\n", cost.trials, cost.cpu_seconds,
          1000 * cost.cpu_seconds / cost.trials, cost.peak_mb);
    }
    if (!out.flush()) return IoError(table_, "cannot be written");
    return absl::OkStatus();
  }

  absl::Status Draw(const std::vector<FitCost>& costs) const {
    LinePlot plot;
    plot.title = "What a fit costs";
    plot.x = {.title = "trials", .scale = AxisScale::kLog};
    plot.y = {.title = "processor time (s), peak memory (MB)",
              .scale = AxisScale::kLog};
    plot.series = {{.name = "peak memory (MB)"},
                   {.name = "processor time (s)"}};
    plot.references = {{.name = "2 GB", .y = 2000}};
    for (const FitCost& cost : costs) {
      for (Series& series : plot.series) series.x.push_back(cost.trials);
      plot.series[0].y.push_back(cost.peak_mb);
      plot.series[1].y.push_back(cost.cpu_seconds);
    }
    return DrawFigure(plot, figure_);
  }

  std::vector<int> trials_ = {1000, 4000, 16'000, 64'000};
  std::string table_;
  std::string figure_;
};

}  // namespace

std::unique_ptr<Benchmark> MakeFitScaleBenchmark() {
  return std::make_unique<FitScaleBenchmark>();
}

}  // namespace tactus::internal::client
