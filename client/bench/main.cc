// tactus-bench: measures a server from the client's side.
#include <cstdio>
#include <fstream>
#include <string>

#include "CLI/CLI.hpp"
#include "client/bench/idle.h"
#include "client/bench/sim.h"
#include "client/stream/percentile.h"
#include "core/base/version.h"
#include "nlohmann/json.hpp"

namespace tactus::client {
namespace {

int RunIdle(const IdleOptions& options, bool json) {
  const auto milliseconds = MeasureIdle(options);
  if (!milliseconds.ok()) {
    std::fprintf(stderr, "tactus-bench: %s\n",
                 std::string(milliseconds.status().message()).c_str());
    return 1;
  }
  const std::pair<const char*, double> shares[] = {
      {"p50", 0.5}, {"p90", 0.9}, {"p99", 0.99}, {"max", 1}};
  auto results = nlohmann::ordered_json::array();
  for (const auto& [name, share] : shares) {
    const double value = Percentile(*milliseconds, share);
    results.push_back({{"name", std::string("idle/first_frame_") + name},
                       {"unit", "ms"},
                       {"ours", value}});
    if (!json) std::printf("first frame %s %.3f ms\n", name, value);
  }
  if (json) std::printf("%s\n", results.dump().c_str());
  return 0;
}

struct SimFlags {
  SimBenchOptions options;
  std::string table;
  bool json = false;
};

void AddSim(CLI::App& app, SimFlags& flags) {
  CLI::App* command =
      app.add_subcommand("sim", "Work and precision of the contact simulator");
  command->add_flag("--quick", flags.options.quick, "A few trials only");
  command->add_flag("--all", flags.options.all,
                    "Compare every trial, and random scenes, with the "
                    "reference: many minutes");
  command
      ->add_option("--random", flags.options.random_scenes,
                   "Random scenes of --all")
      ->capture_default_str();
  command->add_option("--table", flags.table, "Write the table as CSV");
  command->add_flag("--json", flags.json, "Print one JSON array");
}

int RunSim(const SimFlags& flags) {
  const auto report = MeasureSim(flags.options);
  if (!report.ok()) {
    std::fprintf(stderr, "tactus-bench: %s\n",
                 std::string(report.status().message()).c_str());
    return 1;
  }
  if (!flags.table.empty()) {
    std::ofstream file(flags.table);
    file << report->table;
    if (!file.flush()) {
      std::fprintf(stderr, "tactus-bench: %s cannot be written\n",
                   flags.table.c_str());
      return 1;
    }
  }
  if (flags.json) {
    std::printf("%s\n", report->rows.dump().c_str());
    return 0;
  }
  std::printf("%s", report->table.c_str());
  for (const auto& row : report->rows) std::printf("%s\n", row.dump().c_str());
  return 0;
}

int Main(int argc, char** argv) {
  CLI::App app("Measures Tactus.", "tactus-bench");
  app.set_version_flag("--version", std::string("tactus-bench ") + kVersion);
  app.require_subcommand(1);
  IdleOptions idle;
  bool quick = false;
  bool json = false;
  CLI::App* command =
      app.add_subcommand("idle", "Delay of the first frame after a silence");
  command->add_option("--server", idle.server,
                      "host:port or unix:path; else a server of its own");
  CLI::Option* repetitions =
      command->add_option("--repetitions", idle.repetitions, "How often")
          ->check(CLI::Range(1, 1'000'000))
          ->capture_default_str();
  command->add_option("--silence-ms", idle.silence_ms, "Length of the silence")
      ->check(CLI::Range(0, 3'600'000))
      ->capture_default_str();
  command->add_flag("--quick", quick, "Five repetitions")
      ->excludes(repetitions);
  command->add_flag("--json", json, "Print one JSON array");
  SimFlags sim;
  AddSim(app, sim);
  CLI11_PARSE(app, argc, argv);
  if (app.got_subcommand("sim")) return RunSim(sim);
  if (quick) idle.repetitions = 5;
  return RunIdle(idle, json);
}

}  // namespace
}  // namespace tactus::client

int main(int argc, char** argv) { return tactus::client::Main(argc, argv); }
