// tactus-stream: streams simulated or recorded contacts to a server, as a robot
// would, or a real skin, and reports the answers.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "CLI/CLI.hpp"
#include "client/tools/common/skin_source.h"
#include "client/tools/common/token_file.h"
#include "client/tools/stream/live_command.h"
#include "client/tools/stream/monitor_command.h"
#include "client/tools/stream/report.h"
#include "client/tools/stream/trial_player.h"
#include "core/base/arguments.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/version.h"

namespace tactus::client {
namespace {

struct Flags {
  std::string server = "127.0.0.1:50051";
  std::optional<std::string> tls_ca;
  std::string token_file;
  std::string rate = "max";
  int parallel = 1;
  bool json = false;
  bool monitor = false;
  std::string posteriors;
  double timeout_s = 10;
  double reconnect_s = 30;
  double seconds = 0;
  SkinSourceOptions source;
  TrialPlayer::Options player;
};

absl::Status RunSkin(const Flags& flags,
                     const std::shared_ptr<grpc::Channel>& channel,
                     const std::string& token) {
  const LivePlayer::Options player = {.model = flags.player.model,
                                      .sparse = flags.player.sparse,
                                      .seconds = flags.seconds,
                                      .timeouts = flags.player.timeouts,
                                      .resume_for = flags.player.resume_for,
                                      .token = token};
  TACTUS_ASSIGN_OR_RETURN(const auto source, SkinSource::Make(flags.source));
  if (flags.monitor) return RunMonitor(channel, source->driver(), player);
  return RunLive(channel, source->driver(), player, flags.json);
}

absl::Status Run(const Flags& flags) {
  // Standard output is for the one JSON object.
  Report report(flags.json ? stderr : stdout);
  ChannelOptions options;
  if (flags.tls_ca) {
    TACTUS_ASSIGN_OR_RETURN(options.tls_roots,
                            ReadRootCertificates(*flags.tls_ca));
  }
  TrialPlayer::Options player_options = flags.player;
  if (!flags.token_file.empty()) {
    TACTUS_ASSIGN_OR_RETURN(
        player_options.token,
        ReadToken(flags.token_file, flags.server, flags.tls_ca.has_value()));
  }
  const auto channel = MakeChannel(flags.server, options);
  if (flags.source.IsLive() || flags.monitor) {
    return RunSkin(flags, channel, player_options.token);
  }
  std::mutex mutex;
  std::vector<absl::Status> statuses(flags.parallel);
  std::vector<std::thread> threads;
  for (int i = 0; i < flags.parallel; ++i) {
    threads.emplace_back([&, i] {
      const auto driver = MakeTrialDriver(
          flags.source,
          {static_cast<size_t>(i), static_cast<size_t>(flags.parallel)});
      if (!driver.ok()) {
        statuses[i] = driver.status();
        return;
      }
      TrialPlayer* self = nullptr;
      TrialPlayer player(channel, driver->get(), player_options,
                         [&](const TrialResult& result) {
                           const std::lock_guard lock(mutex);
                           report.Add(result);
                           report.PrintLive(result, self->class_names());
                         });
      self = &player;
      statuses[i] = player.Run();
      const std::lock_guard lock(mutex);
      report.AddTotals(player.totals());
      if (!player.class_names().empty()) {
        report.SetClassNames(player.class_names());
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const absl::Status& status : statuses) TACTUS_RETURN_IF_ERROR(status);

  report.PrintTables();
  if (flags.json) std::printf("%s\n", JsonText(report.ToJson()).c_str());
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
                 "PEM file of the authorities that may vouch for the server; "
                 "with it, the connection uses TLS")
      ->check(CLI::ExistingFile);
  app.add_option("--token-file", flags.token_file,
                 "File with the token that the server knows the robot by")
      ->check(CLI::ExistingFile);
  AddSkinFlags(app, flags.source);
  AddCalibrationFlags(app, flags.source);
  app.add_option("--seconds", flags.seconds,
                 "How long to stream a real skin; 0: until Ctrl-C")
      ->check(CLI::Range(0.0, 1e9));
  app.add_option("--trials", flags.source.trials,
                 "Contacts to stream; 0: 40 simulated ones, or all recorded");
  app.add_option("--seed", flags.source.seed, "Seed of the simulated contacts")
      ->capture_default_str();
  app.add_option("--rate", flags.rate,
                 "real: by capture time; max: as fast as answers come")
      ->check(CLI::IsMember({"real", "max"}))
      ->capture_default_str();
  app.add_option("--parallel", flags.parallel, "Streams at once")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--model", flags.player.model, "Model to classify with");
  app.add_flag("--sparse", flags.player.sparse, "Send touched taxels only");
  app.add_option("--batch", flags.player.batch, "Frames per message")
      ->check(CLI::Range(uint32_t{1}, limits::kMaxFramesPerMessage))
      ->capture_default_str();
  app.add_option("--timeout", flags.timeout_s,
                 "Seconds that the server may take to respond; 0: no limit")
      ->check(CLI::Range(0.0, 86'400.0))
      ->capture_default_str();
  app.add_option("--reconnect", flags.reconnect_s,
                 "Seconds within which a lost stream must go on; 0: a loss is "
                 "an error")
      ->check(CLI::Range(0.0, 86'400.0))
      ->capture_default_str();
  app.add_flag("--json", flags.json, "Print one JSON object");
  app.add_flag("--monitor", flags.monitor,
               "Show the skin and the answers in the terminal; simulated and "
               "recorded contacts at the rate of their skin")
      ->excludes("--json");
  app.add_option("--posteriors", flags.posteriors,
                 "File for each trial's final scores, JSON lines");
  if (const absl::Status status = CheckArguments(argc, argv); !status.ok()) {
    std::fprintf(stderr, "tactus-stream: %s\n",
                 std::string(status.message()).c_str());
    return 2;
  }
  CLI11_PARSE(app, argc, argv);
  if (const absl::Status status = CheckSkinFlags(flags.source); !status.ok()) {
    std::fprintf(stderr, "tactus-stream: %s\n",
                 std::string(status.message()).c_str());
    return 2;
  }
  flags.player.real_time = flags.rate == "real";
  const std::chrono::milliseconds timeout(std::llround(1e3 * flags.timeout_s));
  flags.player.timeouts = {timeout, timeout, timeout, timeout};
  flags.player.resume_for =
      std::chrono::milliseconds(std::llround(1e3 * flags.reconnect_s));
  const absl::Status status = Run(flags);
  if (status.ok()) return 0;
  std::fprintf(stderr, "tactus-stream: %s\n",
               std::string(status.message()).c_str());
  return 1;
}

}  // namespace
}  // namespace tactus::client

int main(int argc, char** argv) { return tactus::client::Main(argc, argv); }
