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
#include "client/drivers/buffered_driver.h"
#include "client/drivers/can/socket_can.h"
#include "client/drivers/can_skin_driver.h"
#include "client/drivers/replay_driver.h"
#include "client/drivers/serial/serial_skin.h"
#include "client/drivers/sim_driver.h"
#include "client/drivers/xela/xela_skin.h"
#include "client/tools/common/token_file.h"
#include "client/tools/stream/icub_source.h"
#include "client/tools/stream/live_command.h"
#include "client/tools/stream/report.h"
#include "client/tools/stream/trial_player.h"
#include "core/base/arguments.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/version.h"
#include "core/data/trial_layout.h"

namespace tactus::client {
namespace {

struct Flags {
  std::string server = "127.0.0.1:50051";
  std::optional<std::string> tls_ca;
  std::string token_file;
  std::string driver = "sim";
  std::string data;
  size_t trials = 0;
  uint64_t seed = 1;
  std::string rate = "max";
  int parallel = 1;
  bool json = false;
  std::string posteriors;
  std::string layout;
  std::string skin = "good";
  double timeout_s = 10;
  double reconnect_s = 30;
  double seconds = 0;
  IcubSourceOptions icub;
  TrialPlayer::Options player;

  // A serial skin.
  std::string port;
  std::string format = "ascii";
  int baud = 2'000'000;
  double rate_hz = 30;

  bool IsLive() const {
    return driver == "icub-can" || driver == "icub-usb" || driver == "serial" ||
           driver == "xela-can";
  }
};

constexpr size_t kDefaultSimTrials = 40;

std::unique_ptr<TrialDriver> MakeDriver(
    const Flags& flags, size_t shard, const std::optional<SkinLayout>& layout) {
  const Shard share{shard, static_cast<size_t>(flags.parallel)};
  if (flags.driver == "replay") {
    return std::make_unique<ReplayDriver>(
        flags.data, share,
        ReplayDriver::Options{.max_trials = flags.trials, .layout = layout});
  }
  return std::make_unique<SimDriver>(
      SimDriver::Options{.seed = flags.seed, .skin = flags.skin},
      flags.trials == 0 ? kDefaultSimTrials : flags.trials, share);
}

absl::Status RunSkin(const Flags& flags,
                     const std::shared_ptr<grpc::Channel>& channel,
                     const std::string& token) {
  const LivePlayer::Options player = {.model = flags.player.model,
                                      .sparse = flags.player.sparse,
                                      .seconds = flags.seconds,
                                      .timeouts = flags.player.timeouts,
                                      .resume_for = flags.player.resume_for,
                                      .token = token};
  if (flags.driver == "serial") {
    SerialSkinOptions options = {.format = flags.format == "ascii"
                                               ? SerialFormat::kAscii
                                               : SerialFormat::kAa55,
                                 .baud = flags.baud,
                                 .scale = flags.icub.scale,
                                 .sample_rate_hz = flags.rate_hz};
    TACTUS_ASSIGN_OR_RETURN(options.layout, flags.layout.empty()
                                                ? LayoutPreset("vitac-12x32")
                                                : ReadLayoutFile(flags.layout));
    TACTUS_RETURN_IF_ERROR(AddMask(flags.icub.mask, options.layout));
    SerialSkin skin(flags.port, options);
    HardwareDriver driver(&skin, {});
    BufferedDriver buffered(&driver, {});
    return RunLive(channel, buffered, player, flags.json);
  }
  if (flags.driver == "xela-can") {
    XelaSkinOptions options = {.scale = flags.icub.scale};
    if (!flags.layout.empty()) {
      TACTUS_ASSIGN_OR_RETURN(options.layout, ReadLayoutFile(flags.layout));
    }
    TACTUS_RETURN_IF_ERROR(AddMask(flags.icub.mask, options.layout));
    SocketCan bus(flags.icub.interface);
    XelaSkin skin(options);
    CanSkinDriver driver(&bus, &skin, {});
    BufferedDriver buffered(&driver, {});
    return RunLive(channel, buffered, player, flags.json);
  }
  IcubSourceOptions options = flags.icub;
  options.usb = flags.driver == "icub-usb";
  options.layout = flags.layout;
  TACTUS_ASSIGN_OR_RETURN(const auto source, IcubSource::Make(options));
  return RunLive(channel, source->driver(), player, flags.json);
}

absl::Status Run(const Flags& flags) {
  // Standard output is for the one JSON object.
  Report report(flags.json ? stderr : stdout);
  std::optional<SkinLayout> layout;
  if (!flags.layout.empty() && !flags.IsLive()) {
    TACTUS_ASSIGN_OR_RETURN(layout, ReadLayoutFile(flags.layout));
  }
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
  if (flags.IsLive()) return RunSkin(flags, channel, player_options.token);
  std::mutex mutex;
  std::vector<absl::Status> statuses(flags.parallel);
  std::vector<std::thread> threads;
  for (int i = 0; i < flags.parallel; ++i) {
    threads.emplace_back([&, i] {
      const auto driver = MakeDriver(flags, i, layout);
      TrialPlayer* self = nullptr;
      TrialPlayer player(channel, driver.get(), player_options,
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
  app.add_option("--driver", flags.driver,
                 "sim, replay, icub-can, icub-usb, xela-can or serial "
                 "(docs/drivers.md)")
      ->check(CLI::IsMember(
          {"sim", "replay", "icub-can", "icub-usb", "xela-can", "serial"}))
      ->capture_default_str();
  app.add_option("--skin", flags.skin,
                 "Skin of --driver=sim: paper, good or measured")
      ->capture_default_str();
  app.add_option("--data", flags.data, "Trial file for --driver=replay")
      ->check(CLI::ExistingFile);
  app.add_option("--layout", flags.layout,
                 "JSON file with the skin of trials that carry none, or whose "
                 "cells are a real skin's values in their order")
      ->check(CLI::ExistingFile);
  app.add_option("--interface", flags.icub.interface,
                 "CAN interface for icub-can and xela-can, such as can0");
  app.add_option("--port", flags.port,
                 "Serial line for --driver=serial, such as /dev/ttyUSB0");
  app.add_option("--format", flags.format,
                 "What a serial skin sends: ascii (3D-ViTac) or aa55 "
                 "(FlexiTac)")
      ->check(CLI::IsMember({"ascii", "aa55"}))
      ->capture_default_str();
  app.add_option("--baud", flags.baud, "Rate of the serial line")
      ->capture_default_str();
  app.add_option("--rate-hz", flags.rate_hz, "Frames per second of the skin")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--usb-serial", flags.icub.usb_serial,
                 "Serial number of the adapter for --driver=icub-usb");
  app.add_option("--boards", flags.icub.boards,
                 "Skin boards in the order of the port: forearm-v1, "
                 "forearm-v2, or addresses and triangles, as in 13,12:0-1+3")
      ->capture_default_str();
  app.add_option("--positions", flags.icub.positions,
                 "Position file of the skin, as icub-main has them")
      ->check(CLI::ExistingFile);
  app.add_option("--period-ms", flags.icub.period_ms,
                 "From one scan of the skin to the next")
      ->check(CLI::Range(1, 255))
      ->capture_default_str();
  app.add_option("--scale", flags.icub.scale,
                 "The layout's unit for each count of the skin")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--mask", flags.icub.mask,
                 "Taxels of a real skin to ignore, row-major, as in 17,203")
      ->delimiter(',');
  app.add_option("--seconds", flags.seconds,
                 "How long to stream a real skin; 0: until Ctrl-C")
      ->check(CLI::Range(0.0, 1e9));
  app.add_option("--trials", flags.trials,
                 "Contacts to stream; 0: 40 simulated ones, or all recorded");
  app.add_option("--seed", flags.seed, "Seed of the simulated contacts")
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
  app.add_option("--posteriors", flags.posteriors,
                 "File for each trial's final scores, JSON lines");
  if (const absl::Status status = CheckArguments(argc, argv); !status.ok()) {
    std::fprintf(stderr, "tactus-stream: %s\n",
                 std::string(status.message()).c_str());
    return 2;
  }
  CLI11_PARSE(app, argc, argv);
  if (flags.driver == "replay" && flags.data.empty()) {
    std::fprintf(stderr, "tactus-stream: --driver=replay needs --data\n");
    return 2;
  }
  if (flags.driver == "sim" && !flags.layout.empty()) {
    std::fprintf(stderr, "tactus-stream: --driver=sim has no --layout\n");
    return 2;
  }
  if ((flags.driver == "icub-can" || flags.driver == "xela-can") &&
      flags.icub.interface.empty()) {
    std::fprintf(stderr, "tactus-stream: --driver=%s needs --interface\n",
                 flags.driver.c_str());
    return 2;
  }
  if (flags.driver == "serial" && flags.port.empty()) {
    std::fprintf(stderr, "tactus-stream: --driver=serial needs --port\n");
    return 2;
  }
  if (!flags.layout.empty() && !flags.icub.positions.empty()) {
    std::fprintf(stderr,
                 "tactus-stream: --layout and --positions exclude each "
                 "other\n");
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
