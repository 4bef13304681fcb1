// tactus-bench: measures Tactus and its peers, side by side.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/synchronization/mutex.h"
#include "core/base/version.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/echo_server.h"

namespace tactus::internal::client {
namespace {

struct Command {
  std::unique_ptr<Benchmark> benchmark;
  CLI::App* app = nullptr;
};

int Main(int argc, char** argv) {
  // Debian's Abseil keeps a graph of all locks to find deadlocks, which costs
  // gRPC a twentieth of its time.
  absl::SetMutexDeadlockDetectionMode(absl::OnDeadlockCycle::kIgnore);
  std::vector<Command> commands;
  const auto add = [&](std::unique_ptr<Benchmark> benchmark) {
    commands.push_back({std::move(benchmark)});
  };
  add(MakeFeaturesBenchmark());
  add(MakeLstmBenchmark());
  add(MakeTrainLstmBenchmark());
  add(MakeSessionBenchmark());
  add(MakeFewTrialsBenchmark());
  add(MakeWatchedBenchmark());
  add(MakeSkippingBenchmark());
  add(MakeSimBenchmark());
  add(MakeIdleBenchmark());
  add(MakeRestartBenchmark());
  add(MakeHmmBenchmark());
  add(MakeTrainHmmBenchmark());
  add(MakeStreamBenchmark());
  add(MakeLoadBenchmark());
  add(MakeStartupBenchmark());
  add(MakeTrainingBenchmark());
  add(MakeFrontierBenchmark());
  add(MakeServedBenchmark());
  add(MakeFitScaleBenchmark());

  CLI::App app("Measures Tactus and its peers, side by side.", "tactus-bench");
  app.set_version_flag("--version", std::string("tactus-bench ") + kVersion);
  app.require_subcommand(1);
  bool quick = false;
  bool json = false;
  const auto add_common = [&](CLI::App* command) {
    command->add_flag("--quick", quick, "Only show that it works");
    command->add_flag("--json", json, "Print one JSON array");
  };
  for (Command& command : commands) {
    command.app = app.add_subcommand(command.benchmark->name(),
                                     command.benchmark->description());
    add_common(command.app);
    command.benchmark->AddFlags(*command.app);
  }
  CLI::App* all = app.add_subcommand("all", "All of them, one by one");
  add_common(all);
  std::vector<std::string> names;
  for (const Command& command : commands) {
    names.emplace_back(command.benchmark->name());
  }
  std::vector<std::string> except;
  all->add_option("--except", except, "Leave these out")
      ->delimiter(',')
      ->check(CLI::IsMember(names));
  EchoOptions echo;
  // Not for users: `stream` starts it as its peer.
  CLI::App* echo_server = app.add_subcommand("echo-server")->group("");
  AddEchoFlags(echo, *echo_server);
  CLI11_PARSE(app, argc, argv);
  if (echo_server->parsed()) return RunEchoServer(echo).ok() ? 0 : 1;

  std::vector<BenchRow> rows;
  for (const Command& command : commands) {
    const bool wanted =
        all->parsed() ? std::ranges::find(except, command.benchmark->name()) ==
                            except.end()
                      : command.app->parsed();
    if (!wanted) continue;
    const auto measured = command.benchmark->Run(quick);
    if (!measured.ok()) {
      std::fprintf(stderr, "tactus-bench %s: %s\n", command.benchmark->name(),
                   std::string(measured.status().message()).c_str());
      return 1;
    }
    rows.insert(rows.end(), measured->begin(), measured->end());
  }
  if (!rows.empty()) {
    std::printf("%s\n", (json ? RowsToJson(rows) : RowsToText(rows)).c_str());
  }
  return 0;
}

}  // namespace
}  // namespace tactus::internal::client

int main(int argc, char** argv) {
  return tactus::internal::client::Main(argc, argv);
}
