// trainctl record: labelled trials from a skin, with an operator at a terminal.
#include <chrono>
#include <iostream>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/stream/channel.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "tools/common/measured_rate.h"
#include "tools/common/monitor.h"
#include "tools/common/skin_source.h"
#include "tools/common/terminal.h"
#include "tools/common/token_file.h"
#include "tools/trainctl/remote/flags.h"
#include "tools/trainctl/remote/served_model.h"
#include "tools/trainctl/skin/find_port.h"
#include "tools/trainctl/skin/trial_journal.h"
#include "tools/trainctl/skin/trial_recorder.h"

namespace tactus::internal::client {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kDrawInterval{80};
constexpr size_t kRateFrames = 50;
constexpr double kSilenceS = 10;
constexpr size_t kMostLabels = 9;

struct RecordFlags {
  SkinSourceOptions source;
  RecorderOptions recorder;
  RemoteFlags remote;
  std::string model;
  std::string dataset;
  std::string out;
};

absl::Status CheckFlags(const RecordFlags& flags) {
  TACTUS_RETURN_IF_ERROR(CheckSkinFlags(flags.source));
  const std::vector<std::string>& labels = flags.recorder.labels;
  if (labels.empty() || labels.size() > kMostLabels) {
    return InvalidConfig("--labels", absl::StrCat(labels.size(), " names"),
                         absl::StrCat("1 to ", kMostLabels));
  }
  std::set<std::string> seen;
  for (const std::string& label : labels) {
    const std::string fault = TextFault(label, limits::kMaxTrialTextBytes);
    if (label.empty() || !fault.empty() || !seen.insert(label).second) {
      return InvalidConfig("--labels", Quoted(label), "different names");
    }
  }
  if (!flags.dataset.empty() && flags.remote.server.empty()) {
    return InvalidConfig("--dataset", "given without --server",
                         "given with it");
  }
  if (!flags.model.empty() && flags.remote.server.empty()) {
    return InvalidConfig("--model", "given without --server", "given with it");
  }
  return absl::OkStatus();
}

// One session at a terminal.
class Session {
 public:
  Session(const RecordFlags& flags, SkinSource& source, const SkinInfo& info,
          const SkinInfo* raw_info, TrialJournal& journal)
      : flags_(flags),
        source_(source),
        journal_(journal),
        recorder_(info, raw_info, flags.recorder),
        monitor_(info),
        model_(&monitor_),
        info_(info) {}

  absl::Status OpenModel() {
    if (flags_.remote.server.empty()) return absl::OkStatus();
    ChannelOptions options;
    std::string token;
    if (!flags_.remote.ca.empty()) {
      TACTUS_ASSIGN_OR_RETURN(options.tls_roots,
                              ReadRootCertificates(flags_.remote.ca));
    }
    if (!flags_.remote.token_file.empty()) {
      TACTUS_ASSIGN_OR_RETURN(
          token, ReadToken(flags_.remote.token_file, flags_.remote.server,
                           !flags_.remote.ca.empty()));
    }
    news_ = model_.Open(MakeChannel(flags_.remote.server, options), info_,
                        flags_.model, token);
    return absl::OkStatus();
  }

  // Until the operator ends it, or the skin.
  absl::Status Run() {
    TACTUS_ASSIGN_OR_RETURN(const auto terminal,
                            Terminal::Open("trainctl record"));
    SkinFrame frame;
    auto next_draw = SteadyClock::now();
    while (!terminal->interrupted() && !quit_) {
      TACTUS_ASSIGN_OR_RETURN(const ReadResult result,
                              source_.driver().Read(frame));
      if (result == ReadResult::kEndOfData) break;
      if (result == ReadResult::kFrame) TACTUS_RETURN_IF_ERROR(Take(frame));
      if (result == ReadResult::kEndOfTrial) ShowProblem(model_.EndTrial());
      while (const auto key = terminal->ReadKey()) {
        TACTUS_RETURN_IF_ERROR(Do(recorder_.Key(*key)));
      }
      if (SteadyClock::now() < next_draw) continue;
      next_draw = SteadyClock::now() + kDrawInterval;
      Draw(*terminal);
    }
    return absl::OkStatus();
  }

  const std::vector<int>& counts() const { return recorder_.counts(); }

 private:
  absl::Status Take(const SkinFrame& frame) {
    ShowProblem(model_.Send(frame));
    CalibratedDriver* const calibrated = source_.calibrated();
    return Do(recorder_.Frame(
        frame, calibrated == nullptr ? nullptr : &calibrated->raw()));
  }

  void ShowProblem(const std::string& problem) {
    if (!problem.empty()) news_ = problem;
  }

  absl::Status Do(const RecorderStep& step) {
    if (step.trial) TACTUS_RETURN_IF_ERROR(journal_.Add(*step.trial));
    if (step.undo) TACTUS_RETURN_IF_ERROR(journal_.Undo());
    if (!step.news.empty()) news_ = step.news;
    quit_ |= step.quit;
    return absl::OkStatus();
  }

  void Draw(Terminal& terminal) {
    MonitorState state = monitor_.Snapshot(source_.driver().Statistics());
    // Without a server, the state of the contact is the recorder's.
    if (state.class_names.empty()) {
      state.in_contact = recorder_.in_contact();
      state.contact_s = recorder_.contact_s();
      const FrameFeatures& features = recorder_.features();
      state.max_force = features.max_force;
      state.area_taxels = static_cast<uint32_t>(features.area_taxels);
      state.area_m2 = features.area_m2;
      state.motion_m = features.motion_m;
      state.contact_id = recorder_.contacts();
    }
    std::string counts;
    for (size_t i = 0; i < recorder_.counts().size(); ++i) {
      absl::StrAppend(&counts, flags_.recorder.labels[i], " ",
                      recorder_.counts()[i], "   ");
    }
    const std::string no_poses = source_.driver().Statistics().pose_problem;
    state.footer = {
        StateText(),
        absl::StrCat("kept: ", counts),
        no_poses.empty() ? news_ : "no poses: " + no_poses,
        recorder_.KeysText(),
    };
    const TerminalSize size = terminal.Size();
    terminal.Draw(
        RenderMonitor(state, {size.columns, size.rows, terminal.colour()}));
  }

  std::string StateText() const {
    const auto& label = recorder_.label();
    const std::string name =
        label ? flags_.recorder.labels[*label] : std::string("no label");
    if (!recorder_.in_contact()) {
      return absl::StrCat(
          label ? "waiting for a touch: " : "press the key of a label: ", name);
    }
    return absl::StrFormat(
        "%s %s  %.1f s", recorder_.keeping() ? "RECORDING" : "not kept:", name,
        recorder_.contact_s());
  }

  const RecordFlags& flags_;
  SkinSource& source_;
  TrialJournal& journal_;
  TrialRecorder recorder_;
  Monitor monitor_;
  ServedModel model_;
  const SkinInfo info_;
  std::string news_;
  bool quit_ = false;
};

// Reads frames for the rate, and returns it.
absl::StatusOr<double> MeasureRate(SkinDriver& driver, const SkinInfo& info) {
  MeasuredRate rate;
  SkinFrame frame;
  size_t frames = 0;
  auto last = SteadyClock::now();
  while (frames < kRateFrames) {
    TACTUS_ASSIGN_OR_RETURN(const ReadResult result, driver.Read(frame));
    const auto now = SteadyClock::now();
    if (result == ReadResult::kFrame) {
      rate.Add(frame);
      ++frames;
      last = now;
    }
    if (result == ReadResult::kEndOfData ||
        std::chrono::duration<double>(now - last).count() > kSilenceS) {
      const std::string no_poses = driver.Statistics().pose_problem;
      return IoError("skin",
                     absl::StrCat("sent only ", frames, " frames",
                                  no_poses.empty() ? "" : " with poses",
                                  no_poses.empty() ? "" : ": ", no_poses));
    }
  }
  TACTUS_RETURN_IF_ERROR(rate.Check(info.sample_rate_hz));
  return rate.hz();
}

// Uploads only what is complete on the disk.
absl::Status Upload(const RecordFlags& flags) {
  if (flags.dataset.empty()) return absl::OkStatus();
  return RunRemote(
      flags.remote, [&](TrainingClient& client, const RemoteFlags&) {
        return UploadTrialFile(client, flags.dataset, flags.out, {},
                               /*json=*/false);
      });
}

absl::Status CheckDataset(const RecordFlags& flags) {
  if (flags.dataset.empty()) return absl::OkStatus();
  return RunRemote(
      flags.remote, [&](TrainingClient& client, const RemoteFlags&) {
        return client.GetDataset(FullName("datasets", flags.dataset)).status();
      });
}

absl::Status RunRecord(RecordFlags flags) {
  TACTUS_RETURN_IF_ERROR(CheckFlags(flags));
  TACTUS_RETURN_IF_ERROR(FindPortAloud(flags.source));
  TACTUS_RETURN_IF_ERROR(CheckDataset(flags));
  TACTUS_ASSIGN_OR_RETURN(const auto source, SkinSource::Make(flags.source));
  SkinDriver& driver = source->driver();
  TACTUS_ASSIGN_OR_RETURN(const SkinInfo info, driver.Configure());
  const CalibratedDriver* const calibrated = source->calibrated();
  const SkinInfo* const raw_info =
      calibrated == nullptr ? nullptr : &calibrated->raw_info();
  TACTUS_ASSIGN_OR_RETURN(TrialJournal journal,
                          TrialJournal::Open(flags.out, info, raw_info));
  std::cerr << absl::StrFormat("%s: %s, %d x %d taxels at %g Hz\n",
                               DeviceId(flags.source), info.layout.name,
                               info.layout.rows, info.layout.columns,
                               info.sample_rate_hz);
  const std::string remarks = driver.Statistics().remarks;
  if (!remarks.empty()) std::cerr << remarks << "\n";
  if (ArmSource* const arm = source->arm()) std::cerr << arm->Usage() << "\n";
  if (flags.source.tare_frames > 0) {
    std::cerr << "tare: nothing must touch the skin\n";
  }
  if (journal.recovered() > 0) {
    std::cerr << absl::StrFormat(
        "%d trials of an interrupted session are kept\n", journal.recovered());
  }
  TACTUS_RETURN_IF_ERROR(driver.Activate());
  TACTUS_ASSIGN_OR_RETURN(const double rate_hz, MeasureRate(driver, info));
  std::cerr << absl::StrFormat("measured rate: %.2f Hz\n", rate_hz);
  Session session(flags, *source, info, raw_info, journal);
  TACTUS_RETURN_IF_ERROR(session.OpenModel());
  const absl::Status run = session.Run();
  driver.Finalise().IgnoreError();
  // Whatever ended the session, its trials are kept.
  const auto trials = journal.Finish();
  if (!trials.ok()) return trials.status();
  std::string counts;
  for (size_t i = 0; i < session.counts().size(); ++i) {
    absl::StrAppend(&counts, i > 0 ? ", " : "", flags.recorder.labels[i], " ",
                    session.counts()[i]);
  }
  std::cout << absl::StrFormat("%s: %d trials; this session: %s\n", flags.out,
                               *trials, counts);
  TACTUS_RETURN_IF_ERROR(run);
  return *trials > 0 ? Upload(flags) : absl::OkStatus();
}

}  // namespace

void AddRecord(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<RecordFlags>();
  CLI::App* command = &AddVerb(
      app, "record", "Record labelled trials from a skin, one key per label",
      "record --driver=serial --port=/dev/ttyUSB0 --labels=HU,HM,SU,SM "
      "--out=mine.h5");
  command
      ->add_option("--labels", flags->recorder.labels,
                   "Classes, as in HU,HM,SU,SM; keys 1 to 9 choose them")
      ->delimiter(',')
      ->required();
  command
      ->add_option("--out", flags->out,
                   "Trial file; trials are added to those that it holds")
      ->required();
  AddSkinFlags(*command, flags->source);
  AddCalibrationFlags(*command, flags->source);
  AddPoseFlags(*command, flags->source);
  command->add_option("--seed", flags->source.seed,
                      "Seed of the simulated contacts");
  command->add_option("--trials", flags->source.trials,
                      "Simulated or recorded contacts to play");
  command->add_option("--condition", flags->recorder.condition,
                      "How the robot moves, of all trials");
  command->add_option("--object", flags->recorder.object,
                      "What is touched, of all trials");
  command->add_option("--group", flags->recorder.group,
                      "What must not be on both sides of a test, of all "
                      "trials");
  command
      ->add_option("--pre-roll-s", flags->recorder.pre_roll_s,
                   "Seconds before the onset that a trial has")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  command
      ->add_option("--release-after-s", flags->recorder.release_after_s,
                   "Seconds without touch that end a contact and a trial")
      ->check(CLI::Range(0.05, 10.0))
      ->capture_default_str();
  command
      ->add_option("--shortest-s", flags->recorder.shortest_s,
                   "A shorter contact is not kept")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  command
      ->add_option("--longest-s", flags->recorder.longest_s,
                   "A longer contact is not kept")
      ->check(CLI::Range(0.1, 600.0))
      ->capture_default_str();
  flags->remote.AddServer(*command);
  command->add_option("--model", flags->model,
                      "Model of the server to show the posterior of");
  command->add_option("--dataset", flags->dataset,
                      "Dataset of the server to upload the trials to");
  command->callback([=] { select([=] { return RunRecord(*flags); }); });
}

}  // namespace tactus::internal::client
