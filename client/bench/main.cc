// tactus-bench: measures a server from the client's side.
#include <cstdio>
#include <string>

#include "CLI/CLI.hpp"
#include "client/bench/idle.h"
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

int Main(int argc, char** argv) {
  CLI::App app("Measures a Tactus server.", "tactus-bench");
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
  CLI11_PARSE(app, argc, argv);
  if (quick) idle.repetitions = 5;
  return RunIdle(idle, json);
}

}  // namespace
}  // namespace tactus::client

int main(int argc, char** argv) { return tactus::client::Main(argc, argv); }
