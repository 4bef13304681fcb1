// tactus-load: an open-loop load generator for a Tactus server.
#include <cstdio>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "client/stream/channel.h"
#include "core/base/arguments.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/version.h"
#include "tools/load/find_max.h"
#include "tools/load/load.h"
#include "tools/load/load_processes.h"

namespace tactus::internal::client {
namespace {

struct Flags {
  LoadOptions load = {.servers = {"127.0.0.1:50051"}};
  FindMaxOptions search;
  std::optional<std::string> tls_ca;
  // Set in a process of a test of several.
  std::optional<int> part;
  bool find_max = false;
  bool json = false;
};

// Names of `--cadence`.
const std::map<std::string, v1::ResultCadence> kCadences = {
    {"every-frame", v1::RESULT_CADENCE_EVERY_FRAME},
    {"every-message", v1::RESULT_CADENCE_EVERY_N_FRAMES},
    {"on-change", v1::RESULT_CADENCE_ON_CHANGE},
    {"events", v1::RESULT_CADENCE_EVENTS}};

void PrintTest(const LoadReport& test) {
  std::fprintf(stderr, "%d robots: p99 %.3f ms, %llu lost, %d refused\n",
               test.robots, test.p99_ms,
               static_cast<unsigned long long>(test.lost()), test.refused);
}

// `words` are the flags as they were given.
absl::StatusOr<LoadReport> Measure(const Flags& flags,
                                   const std::vector<std::string>& words) {
  const LoadOptions& load = flags.load;
  if (load.parts == 1) {
    return flags.find_max ? FindMaxRobots(load, flags.search, PrintTest)
                          : RunLoad(load);
  }
  TACTUS_ASSIGN_OR_RETURN(
      const auto processes,
      LoadProcesses::Start("/proc/self/exe", words, load.parts));
  const auto run = [&processes](int robots) { return processes->Run(robots); };
  return flags.find_max ? FindMaxRobots(flags.search, run, PrintTest)
                        : run(load.robots);
}

// Prints why the test could not run, and returns the exit code.
int Complain(const absl::Status& status) {
  std::fprintf(stderr, "tactus-load: %s\n",
               std::string(status.message()).c_str());
  return 2;
}

int Main(int argc, char** argv) {
  Flags flags;
  LoadOptions& load = flags.load;
  CLI::App app("Loads a Tactus server with robots that do not wait.",
               "tactus-load");
  app.set_version_flag("--version", std::string("tactus-load ") + kVersion);
  app.add_option("--server", load.servers,
                 "host:port or unix:path; robots are spread over several, with "
                 "commas between them or the flag repeated")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--tls-ca", flags.tls_ca,
                 "PEM file of the authorities that may vouch for the server; "
                 "with it, the connection uses TLS")
      ->check(CLI::ExistingFile);
  app.add_option("--robots", load.robots, "Streams at once")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  app.add_option("--rate", load.rate_hz, "Frames a second of each robot")
      ->check(CLI::Range(0.1, limits::kMaxSampleRateHz))
      ->capture_default_str();
  app.add_option("--seconds", load.seconds, "Length, the warm-up included")
      ->check(CLI::Range(0.1, 1e6))
      ->capture_default_str();
  app.add_option("--warm-up", load.warm_up_seconds,
                 "Seconds at the start that are in no percentile")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  app.add_option("--frames-per-message", load.frames_per_message,
                 "Frames sent together")
      ->check(CLI::Range(uint32_t{1}, limits::kMaxFramesPerMessage))
      ->capture_default_str();
  app.add_option("--cadence", load.cadence,
                 "Frames that the server answers: every-frame, every-message "
                 "(its last), on-change, events")
      ->transform(CLI::CheckedTransformer(kCadences))
      ->default_str("every-frame");
  app.add_flag("--sparse", load.sparse, "Send touched taxels only");
  app.add_option("--untouched-seconds", load.untouched_seconds,
                 "Of each robot between two contacts")
      ->check(CLI::Range(0.01, 10.0))
      ->capture_default_str();
  app.add_option("--touched-fraction", load.touched_fraction,
                 "Of all frames, those of contacts: 0, or 0.02 to 1")
      ->check(CLI::Range(0.0, 1.0))
      ->excludes("--untouched-seconds");
  app.add_option(
         "--arrivals", load.arrivals_seconds,
         "Mean seconds until a robot ends its stream and opens another; "
         "0: never")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  app.add_option("--slow-readers", load.slow_readers,
                 "Robots that take one answer a second")
      ->check(CLI::Range(0, 100'000))
      ->capture_default_str();
  app.add_option("--connections", load.connections,
                 "Connections the robots share; 0: one for each stream")
      ->check(CLI::Range(0, 100'000))
      ->capture_default_str();
  app.add_option("--processes", load.parts,
                 "Generators that run at the same time, each with a part of "
                 "the robots")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  // How this program starts itself.
  app.add_option("--part", flags.part)->group("");
  app.add_option("--seed", load.seed, "Of the contacts and the robots' phases")
      ->capture_default_str();
  app.add_flag("--find-max", flags.find_max,
               "Search the largest number of robots that keeps the limit");
  app.add_option("--p99-limit-ms", flags.search.p99_limit_ms,
                 "The limit of --find-max")
      ->check(CLI::Range(0.01, 1e6))
      ->capture_default_str();
  app.add_flag("--json", flags.json, "Print one JSON object");
  if (const absl::Status status = CheckArguments(argc, argv); !status.ok()) {
    return Complain(status);
  }
  CLI11_PARSE(app, argc, argv);

  if (flags.tls_ca) {
    auto roots = ReadRootCertificates(*flags.tls_ca);
    if (!roots.ok()) return Complain(roots.status());
    load.tls_roots = *std::move(roots);
  }
  if (flags.part) {
    load.part = *flags.part;
    const absl::Status status = ServeLoadParts(load);
    return status.ok() ? 0 : Complain(status);
  }
  const auto report = Measure(flags, {argv + 1, argv + argc});
  if (!report.ok()) return Complain(report.status());
  const auto max_robots =
      flags.find_max ? std::optional(report->robots) : std::nullopt;
  const std::string text =
      flags.json ? LoadToJson(*report, max_robots) + "\n" : LoadToText(*report);
  std::fputs(text.c_str(), stdout);
  return report->ok() && report->robots > 0 ? 0 : 1;
}

}  // namespace
}  // namespace tactus::internal::client

int main(int argc, char** argv) {
  return tactus::internal::client::Main(argc, argv);
}
