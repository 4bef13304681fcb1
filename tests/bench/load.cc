#include "tools/load/load.h"

#include <algorithm>
#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/child_server.h"
#include "tools/common/percentile.h"
#include "tools/load/find_max.h"

namespace tactus::internal::client {
namespace {

struct LoadBenchOptions {
  LoadOptions load = {.robots = 200,
                      .seconds = 5,
                      .cadence = v1::RESULT_CADENCE_EVERY_N_FRAMES,
                      .connections = 8};
  FindMaxOptions search = {.min_robots = 100};
  int repetitions = 3;
};

absl::StatusOr<std::vector<BenchRow>> FixedLoad(
    const LoadBenchOptions& options) {
  TACTUS_ASSIGN_OR_RETURN(const FrameScript script, MakeScript(options.load));
  std::vector<double> p50, p99, lost;
  for (int i = 0; i < options.repetitions; ++i) {
    TACTUS_ASSIGN_OR_RETURN(const LoadReport report,
                            RunLoad(options.load, script));
    if (report.refused + report.failed > 0) {
      return IoError("tactusd", report.first_error);
    }
    p50.push_back(report.p50_ms);
    p99.push_back(report.p99_ms);
    lost.push_back(static_cast<double>(report.lost()));
  }
  const std::string name = absl::StrCat("load/", options.load.robots, "x100_");
  return std::vector<BenchRow>{
      {.name = name + "p50", .unit = "ms", .ours = Percentile(p50, 0.5)},
      {.name = name + "p99", .unit = "ms", .ours = Percentile(p99, 0.5)},
      {.name = name + "lost", .unit = "answers", .ours = Percentile(lost, 0.5)},
  };
}

class LoadBenchmark : public Benchmark {
 public:
  const char* name() const override { return "load"; }
  const char* description() const override {
    return "Robots that one server answers in time";
  }

  void AddFlags(CLI::App& command) override {
    command.add_option("--seconds", options_.load.seconds, "Of each test")
        ->check(CLI::Range(1.5, 1e6))
        ->capture_default_str();
    command
        .add_option("--connections", options_.load.connections,
                    "That the robots share; 0: one each")
        ->check(CLI::Range(0, 100'000))
        ->capture_default_str();
    command
        .add_option("--untouched-seconds", options_.load.untouched_seconds,
                    "Of each robot between two contacts")
        ->check(CLI::Range(0.01, 10.0))
        ->capture_default_str();
    command
        .add_option("--repetitions", options_.repetitions,
                    "Tests of 200 robots; medians count")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
  }

  absl::StatusOr<std::vector<BenchRow>> Run(bool quick) override {
    LoadBenchOptions options = options_;
    if (quick) {
      options.repetitions = 1;
      options.load.robots = 10;
      options.load.seconds = 0.2;
      options.load.warm_up_seconds = 0.05;
      options.search = {.min_robots = 4, .max_robots = 4, .attempts = 1};
    }
    TACTUS_ASSIGN_OR_RETURN(
        const auto server,
        ChildServer::Start(
            "tactusd", {"--listen=127.0.0.1:0", "--log-level=error",
                        "--max-streams-per-peer=0",
                        absl::StrCat("--max-streams=",
                                     std::max(options.load.robots,
                                              options.search.max_robots))}));
    options.load.servers = {server->address()};
    TACTUS_ASSIGN_OR_RETURN(std::vector<BenchRow> rows, FixedLoad(options));
    for (const uint32_t frames : {1u, 4u}) {
      options.load.frames_per_message = frames;
      TACTUS_ASSIGN_OR_RETURN(const LoadReport most,
                              FindMaxRobots(options.load, options.search,
                                            [](const LoadReport&) {}));
      rows.push_back(
          {.name = absl::StrCat("load/max_robots_", frames, "_per_message"),
           .unit = "robots",
           .ours = static_cast<double>(most.robots)});
    }
    return rows;
  }

 private:
  LoadBenchOptions options_;
};

}  // namespace

std::unique_ptr<Benchmark> MakeLoadBenchmark() {
  return std::make_unique<LoadBenchmark>();
}

}  // namespace tactus::internal::client
