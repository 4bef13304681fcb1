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
#include "client/drivers/recording_driver.h"
#include "client/stream/robot_id.h"
#include "core/base/arguments.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "tools/common/skin_source.h"
#include "tools/common/token_file.h"
#include "tools/common/vetted_servers.h"
#include "tools/stream/event_printer.h"
#include "tools/stream/live_command.h"
#include "tools/stream/monitor_command.h"
#include "tools/stream/record_replay.h"
#include "tools/stream/report.h"
#include "tools/stream/trial_player.h"

namespace tactus::internal::client {
namespace {

struct Flags {
  std::string server = "127.0.0.1:50051";
  std::optional<std::string> tls_ca;
  std::string token_file;
  std::string rate = "max";
  int parallel = 1;
  bool json = false;
  bool monitor = false;
  bool events = false;
  std::string posteriors;
  double timeout_s = 10;
  double reconnect_s = 30;
  double seconds = 0;
  SkinSourceOptions source;
  TrialPlayer::Options player;
  std::string record;
  // Labels of the trial that a real skin's recording is.
  std::string label;
  std::string condition;
  std::string object;

  // The driver is played as a skin: its contacts are not compared with labels.
  bool IsSkin() const { return source.IsLive() || monitor || events; }

  bool IsReplayOfRecording() const {
    return source.driver == "replay" && IsRecording(source.data);
  }
};

absl::StatusOr<std::unique_ptr<LabelledDriver>> MakeDriver(const Flags& flags,
                                                           size_t shard,
                                                           AnswerCheck& check) {
  if (flags.IsReplayOfRecording()) {
    return std::make_unique<RecordingDriver>(
        flags.source.data,
        RecordingDriver::Options{.max_trials = flags.source.trials,
                                 .on_event = EventsTo(check)});
  }
  return MakeTrialDriver(flags.source,
                         {shard, static_cast<size_t>(flags.parallel)});
}

// For example that a recording was cut off.
void PrintProblem(const SkinDriver& driver) {
  const std::string problem = driver.Statistics().problem;
  if (problem.empty()) return;
  std::fprintf(stderr, "tactus-stream: %s\n", problem.c_str());
}

// Null without --record. `device` names a real skin.
absl::StatusOr<std::unique_ptr<Recorder>> MakeRecorder(
    const Flags& flags, bool is_live, uint32_t batch,
    const std::string& device) {
  if (flags.record.empty()) return nullptr;
  Recorder::Options options;
  options.about = {{"program", absl::StrCat("tactus-stream ", kVersion)},
                   {"driver", flags.source.driver},
                   {"stream", is_live ? "skin" : "trials"},
                   {"batch", absl::StrCat(is_live ? 1 : batch)}};
  if (!device.empty()) options.about["device"] = device;
  if (flags.source.driver == "sim") {
    options.about["seed"] = absl::StrCat(flags.source.seed);
    options.about["skin"] = flags.source.skin;
  }
  // A real skin does not wait.
  options.wait_when_full = !flags.source.IsLive();
  return Recorder::Create(flags.record, options);
}

// Plays the recording of a real skin.
absl::Status ReplaySkin(const Flags& flags,
                        const std::shared_ptr<grpc::Channel>& channel,
                        LivePlayer::Options player) {
  TACTUS_ASSIGN_OR_RETURN(const RecordingStart start,
                          ReadRecordingStart(flags.source.data));
  AnswerCheck check;
  player.check = &check;
  player.release_after_ms =
      start.config.never_release()
          ? -1
          : static_cast<int>(start.config.release_after_ms());
  if (start.config.has_max_contacts()) {
    player.max_contacts = static_cast<int>(start.config.max_contacts());
  }
  player.cadence = start.config.cadence();
  if (player.model.empty()) player.model = start.config.model();
  for (auto& [key, value] : player.trial) {
    if (value.empty()) value = start.trial.Text(key);
  }
  RecordingDriver recording(flags.source.data,
                            {.max_trials = flags.source.trials,
                             .real_time = flags.player.real_time,
                             .raw = flags.source.IsCalibrated(),
                             .on_event = EventsTo(check)});
  SkinDriver* driver = &recording;
  std::optional<CalibratedDriver> calibrated;
  if (flags.source.IsCalibrated()) {
    TACTUS_ASSIGN_OR_RETURN(
        CalibratedDriverOptions options,
        CalibratedOptions(flags.source, flags.source.device_id));
    calibrated.emplace(&recording, Recalibration(start, std::move(options)));
    driver = &*calibrated;
    player.calibrated = &*calibrated;
  }
  TACTUS_RETURN_IF_ERROR(RunLive(channel, *driver, player, flags.json));
  PrintProblem(recording);
  if (flags.json) {
    std::printf("%s\n", JsonText(Json{{"replay", ToJson(check)}}).c_str());
  } else {
    std::printf("%s\n", check.Text().c_str());
  }
  return absl::OkStatus();
}

absl::Status RunSkin(const Flags& flags,
                     const std::shared_ptr<grpc::Channel>& channel,
                     const std::string& token, Recorder* recorder) {
  LivePlayer::Options player = {.model = flags.player.model,
                                .sparse = flags.player.sparse,
                                .seconds = flags.seconds,
                                .timeouts = flags.player.timeouts,
                                .resume_for = flags.player.resume_for,
                                .token = token,
                                .client_id = flags.player.client_id,
                                .recorder = recorder,
                                .trial = {{"label", flags.label},
                                          {"condition", flags.condition},
                                          {"object", flags.object}}};
  if (flags.IsReplayOfRecording()) return ReplaySkin(flags, channel, player);
  TACTUS_ASSIGN_OR_RETURN(const auto source, SkinSource::Make(flags.source));
  player.calibrated = source->calibrated();
  player.labelled = dynamic_cast<const LabelledDriver*>(&source->driver());
  ArmSource* const arm = source->arm();
  if (arm != nullptr) {
    player.pose_at = [arm](int64_t time_ns) { return arm->PoseAt(time_ns); };
    std::fprintf(stderr, "tactus-stream: %s\n", arm->Usage().c_str());
  }
  EventPrinter printer(flags.json);
  if (flags.events) player.observer = &printer;
  const absl::Status status =
      flags.monitor ? RunMonitor(channel, source->driver(), player)
                    : RunLive(channel, source->driver(), player, flags.json);
  if (arm != nullptr) {
    std::fprintf(stderr, "tactus-stream: %s\n", arm->Summary().c_str());
  }
  return status;
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
  bool is_live = flags.IsSkin();
  std::string device = is_live ? DeviceId(flags.source) : "";
  if (flags.IsReplayOfRecording()) {
    TACTUS_ASSIGN_OR_RETURN(const RecordingStart start,
                            ReadRecordingStart(flags.source.data));
    is_live = start.is_live;
    device =
        flags.source.device_id.empty() ? start.device : flags.source.device_id;
    if (!is_live && flags.source.IsCalibrated()) {
      return InvalidConfig("--calibration or --tare",
                           "given with a recording of trials",
                           "absent without a real skin");
    }
    if (flags.monitor || flags.events) {
      return InvalidConfig(flags.monitor ? "--monitor" : "--events",
                           "a recording",
                           "a skin, or a trial file (trainctl import)");
    }
    // Frames of a message have the times of their first frame.
    if (player_options.batch != 1 && player_options.batch != start.batch) {
      return InvalidConfig("--batch", player_options.batch,
                           absl::StrCat(start.batch, ", as recorded"));
    }
    player_options.batch = start.batch;
    if (player_options.model.empty()) {
      player_options.model = start.config.model();
    }
  }
  for (const std::string* text :
       {&flags.label, &flags.condition, &flags.object}) {
    if (is_live || text->empty()) continue;
    return InvalidConfig("--label, --condition or --object", *text,
                         "absent: the trials have their own");
  }
  TACTUS_ASSIGN_OR_RETURN(
      const auto recorder,
      MakeRecorder(flags, is_live, player_options.batch, device));
  if (is_live) {
    const absl::Status status =
        RunSkin(flags, channel, player_options.token, recorder.get());
    const absl::Status recorded =
        FinishRecorder(recorder.get(), flags.record, stderr);
    return status.ok() ? recorded : status;
  }
  AnswerCheck check;
  player_options.recorder = recorder.get();
  if (flags.IsReplayOfRecording()) player_options.check = &check;
  std::mutex mutex;
  std::vector<absl::Status> statuses(flags.parallel);
  std::vector<std::thread> threads;
  std::string rate_news;
  std::string skin_news;
  for (int i = 0; i < flags.parallel; ++i) {
    threads.emplace_back([&, i] {
      const auto driver = MakeDriver(flags, i, check);
      if (!driver.ok()) {
        statuses[i] = driver.status();
        return;
      }
      TrialPlayer* self = nullptr;
      TrialPlayer player(channel, driver->get(), player_options,
                         [&](const TrialResult& result) {
                           const std::lock_guard lock(mutex);
                           report.SetClassNames(self->class_names());
                           report.Add(result);
                         });
      self = &player;
      statuses[i] = player.Run();
      PrintProblem(**driver);
      const std::lock_guard lock(mutex);
      report.AddTotals(player.totals());
      if (rate_news.empty()) rate_news = player.totals().rate_news;
      if (skin_news.empty()) skin_news = player.totals().skin_news;
      if (!player.class_names().empty()) {
        report.SetClassNames(player.class_names());
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::string& news : {rate_news, skin_news}) {
    if (news.empty()) continue;
    std::fprintf(stderr, "tactus-stream: %s\n", news.c_str());
  }
  std::FILE* const out = flags.json ? stderr : stdout;
  const absl::Status recorded =
      FinishRecorder(recorder.get(), flags.record, out);
  for (const absl::Status& status : statuses) TACTUS_RETURN_IF_ERROR(status);
  TACTUS_RETURN_IF_ERROR(recorded);

  report.PrintSummary();
  Json json = report.ToJson();
  if (flags.IsReplayOfRecording()) {
    std::fprintf(out, "%s\n", check.Text().c_str());
    json["replay"] = ToJson(check);
  }
  if (flags.json) std::printf("%s\n", JsonText(json).c_str());
  if (flags.posteriors.empty()) return absl::OkStatus();
  return report.WritePosteriors(flags.posteriors);
}

absl::Status CheckFlags(const Flags& flags) {
  TACTUS_RETURN_IF_ERROR(CheckSkinFlags(flags.source));
  const std::string& client_id = flags.player.client_id;
  if (!client_id.empty() && !IsRobotId(client_id)) {
    return InvalidConfig("--client-id", Quoted(client_id),
                         "printable ASCII without a space at its ends");
  }
  if (flags.IsReplayOfRecording() && !flags.source.layout.empty()) {
    return InvalidConfig("--layout", "given",
                         "absent: a recording has its skin");
  }
  if (flags.source.objects > 1 && !flags.IsSkin()) {
    return InvalidConfig("--objects", flags.source.objects,
                         "1 without --events or --monitor: a trial with "
                         "several contacts has several answers");
  }
  if (flags.parallel > 1 &&
      (!flags.record.empty() || flags.IsReplayOfRecording())) {
    return InvalidConfig("--parallel", flags.parallel,
                         "1: a recording is of one stream");
  }
  if (flags.record.empty() && (!flags.label.empty() || !flags.object.empty() ||
                               !flags.condition.empty())) {
    return InvalidConfig("--record", "absent",
                         "given with --label, --condition or --object");
  }
  return absl::OkStatus();
}

int Main(int argc, char** argv) {
  VetServers("tactus-stream");
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
  app.add_option("--client-id", flags.player.client_id,
                 "Name of the robot, for the server's log and for a proxy: "
                 "printable ASCII");
  AddSkinFlags(app, flags.source);
  AddCalibrationFlags(app, flags.source);
  AddPoseFlags(app, flags.source);
  app.add_option("--record", flags.record,
                 "MCAP file to record frames, poses and answers to; it must "
                 "not exist");
  app.add_option("--label", flags.label,
                 "Class of the contacts in the recording of a real skin");
  app.add_option("--condition", flags.condition,
                 "Robot condition in the recording of a real skin");
  app.add_option("--object", flags.object,
                 "Object in the recording of a real skin");
  app.add_option("--seconds", flags.seconds,
                 "How long to stream a real skin; 0: until Ctrl-C")
      ->check(CLI::Range(0.0, 1e9));
  app.add_option("--trials", flags.source.trials,
                 "Contacts to stream; 0: 40 simulated ones, or all recorded");
  app.add_option("--seed", flags.source.seed, "Seed of the simulated contacts")
      ->capture_default_str();
  app.add_option("--rate", flags.rate,
                 "real or 1x: by capture time; max: as fast as answers come")
      ->check(CLI::IsMember({"real", "1x", "max"}))
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
  app.add_flag("--events", flags.events,
               "Print a line for each event, as it happens; simulated and "
               "recorded contacts at the rate of their skin")
      ->excludes("--monitor");
  app.add_option("--posteriors", flags.posteriors,
                 "File for each trial's final scores, JSON lines");
  if (const absl::Status status = CheckArguments(argc, argv); !status.ok()) {
    std::fprintf(stderr, "tactus-stream: %s\n",
                 std::string(status.message()).c_str());
    return 2;
  }
  CLI11_PARSE(app, argc, argv);
  if (const absl::Status status = CheckFlags(flags); !status.ok()) {
    std::fprintf(stderr, "tactus-stream: %s\n",
                 std::string(status.message()).c_str());
    return 2;
  }
  const auto port = FindPort(flags.source);
  if (!port.ok() || !port->empty()) {
    std::fprintf(stderr, "tactus-stream: %s\n",
                 port.ok() ? port->c_str()
                           : std::string(port.status().message()).c_str());
  }
  if (!port.ok()) return 1;
  flags.player.real_time = flags.rate != "max";
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
}  // namespace tactus::internal::client

int main(int argc, char** argv) {
  return tactus::internal::client::Main(argc, argv);
}
