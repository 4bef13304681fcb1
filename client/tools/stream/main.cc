// tactus-stream: the robot process. Streams simulated or recorded contacts to
// a server and reports what it answers.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "CLI/CLI.hpp"
#include "client/drivers/replay_driver.h"
#include "client/drivers/sim_driver.h"
#include "client/tools/stream/report.h"
#include "client/tools/stream/robot.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/version.h"

namespace tactus::client {
namespace {

struct Flags {
  std::string server = "127.0.0.1:50051";
  std::string tls_ca;
  std::string driver = "sim";
  std::string data;
  size_t trials = 0;
  uint64_t seed = 1;
  std::string rate = "max";
  int parallel = 1;
  bool json = false;
  std::string posteriors;
  Robot::Options robot;
};

constexpr size_t kDefaultSimTrials = 40;

std::unique_ptr<TrialDriver> MakeDriver(const Flags& flags, size_t shard) {
  const Shard share{shard, static_cast<size_t>(flags.parallel)};
  if (flags.driver == "replay") {
    return std::make_unique<ReplayDriver>(flags.data, share, flags.trials);
  }
  return std::make_unique<SimDriver>(
      SimDriver::Options{.seed = flags.seed, .render = {}},
      flags.trials == 0 ? kDefaultSimTrials : flags.trials, share);
}

absl::Status Run(const Flags& flags) {
  // Standard output is for the one JSON object.
  Report report(flags.json ? stderr : stdout);
  TACTUS_ASSIGN_OR_RETURN(const std::string roots,
                          ReadRootCertificates(flags.tls_ca));
  const auto channel = MakeChannel(flags.server, {.tls_roots = roots});
  std::mutex mutex;
  std::vector<absl::Status> statuses(flags.parallel);
  std::vector<std::thread> threads;
  for (int i = 0; i < flags.parallel; ++i) {
    threads.emplace_back([&, i] {
      const auto driver = MakeDriver(flags, i);
      Robot* self = nullptr;
      Robot robot(channel, driver.get(), flags.robot,
                  [&](const TrialResult& result) {
                    const std::lock_guard lock(mutex);
                    report.Add(result);
                    report.PrintLive(result, self->class_names());
                  });
      self = &robot;
      statuses[i] = robot.Run();
      const std::lock_guard lock(mutex);
      report.AddTotals(robot.totals());
      if (!robot.class_names().empty()) {
        report.SetClassNames(robot.class_names());
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const absl::Status& status : statuses) TACTUS_RETURN_IF_ERROR(status);

  report.PrintTables();
  if (flags.json) std::printf("%s\n", report.ToJson().dump().c_str());
  if (flags.posteriors.empty()) return absl::OkStatus();
  return report.WritePosteriors(flags.posteriors);
}

int Main(int argc, char** argv) {
  Flags flags;
  CLI::App app("Streams contacts to a Tactus server as a robot would.",
               "tactus-stream");
  app.set_version_flag("--version", std::string("tactus-stream ") + kVersion);
  app.add_option("--server", flags.server, "host:port or unix:path")
      ->capture_default_str();
  app.add_option("--tls-ca", flags.tls_ca,
                 "PEM file of who may vouch for the server: use TLS");
  app.add_option("--driver", flags.driver, "sim or replay")
      ->check(CLI::IsMember({"sim", "replay"}))
      ->capture_default_str();
  app.add_option("--data", flags.data, "Trial file for --driver=replay")
      ->check(CLI::ExistingFile);
  app.add_option("--trials", flags.trials,
                 "Contacts to stream; 0: 40 simulated ones, or all recorded");
  app.add_option("--seed", flags.seed, "Of the simulated contacts")
      ->capture_default_str();
  app.add_option("--rate", flags.rate,
                 "real: by capture time; max: as fast as answers come")
      ->check(CLI::IsMember({"real", "max"}))
      ->capture_default_str();
  app.add_option("--parallel", flags.parallel, "Robots at once")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--model", flags.robot.model, "Model to classify with");
  app.add_flag("--sparse", flags.robot.sparse, "Send touched taxels only");
  app.add_option("--batch", flags.robot.batch, "Frames a message")
      ->check(CLI::Range(uint32_t{1}, limits::kMaxFramesPerMessage))
      ->capture_default_str();
  app.add_flag("--json", flags.json, "Print one JSON object");
  app.add_option("--posteriors", flags.posteriors,
                 "File for each trial's final scores, JSON lines");
  CLI11_PARSE(app, argc, argv);
  if (flags.driver == "replay" && flags.data.empty()) {
    std::fprintf(stderr, "tactus-stream: --driver=replay needs --data\n");
    return 2;
  }
  flags.robot.real_time = flags.rate == "real";
  const absl::Status status = Run(flags);
  if (status.ok()) return 0;
  std::fprintf(stderr, "tactus-stream: %s\n",
               std::string(status.message()).c_str());
  return 1;
}

}  // namespace
}  // namespace tactus::client

int main(int argc, char** argv) { return tactus::client::Main(argc, argv); }
