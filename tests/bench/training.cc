#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/strings/str_cat.h"
#include "client/training/operation_watcher.h"
#include "client/training/training_client.h"
#include "client/training/trial_uploader.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/bundle/bundle.h"
#include "core/data/trial_file.h"
#include "core/sim/exact/simulate_contact.h"
#include "core/sim/experiments/paper_set.h"
#include "server/registry/default_bundle.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/child_server.h"
#include "tests/bench/temporary_folder.h"
#include "tools/common/percentile.h"
#include "tools/load/load.h"

namespace tactus::internal::client {
namespace {

using std::chrono::duration;
using std::chrono::steady_clock;

constexpr char kData[] = "datasets/bench";
constexpr char kSignals[] = "datasets/bench-signals";
constexpr char kModel[] = "models/bench";
constexpr char kAlias[] = "aliases/default";

struct TrainingBenchOptions {
  // Empty: some simulated trials.
  std::string data;
  std::vector<std::string> server;
  int turns = 3;
  int activations = 100;
  // Not empty: only promotes, on this server.
  std::string promote_on;
  LoadOptions load = {.robots = 100, .seconds = 10};
};

double SecondsSince(steady_clock::time_point begin) {
  return duration<double>(steady_clock::now() - begin).count();
}

absl::StatusOr<std::vector<Trial>> SimulatedTrials(size_t count) {
  std::vector<Trial> trials;
  for (const TrialSpec& spec : TrialSpecs(PaperGrid().Conditions())) {
    TACTUS_ASSIGN_OR_RETURN(const auto contacts, SimulateWithTwin(spec));
    for (const SimulatedContact& contact : contacts) {
      trials.push_back(SignalTrial(contact, {}, 1));
    }
    if (trials.size() >= count) break;
  }
  return trials;
}

// The trials of a file, or the simulated ones.
class Trials {
 public:
  static absl::StatusOr<Trials> Open(const std::string& path, size_t count) {
    Trials trials;
    if (path.empty()) {
      TACTUS_ASSIGN_OR_RETURN(trials.made_, SimulatedTrials(count));
    } else {
      TACTUS_ASSIGN_OR_RETURN(auto reader, TrialFileReader::Open(path));
      trials.reader_.emplace(std::move(reader));
    }
    return trials;
  }
  absl::StatusOr<std::optional<Trial>> Next() {
    const size_t size = reader_ ? reader_->size() : made_.size();
    if (next_ == size) return std::nullopt;
    if (reader_) return reader_->Read(next_++);
    return made_[next_++];
  }

 private:
  std::vector<Trial> made_;
  std::optional<TrialFileReader> reader_;
  size_t next_ = 0;
};

absl::StatusOr<v1::DatasetVersion> Upload(TrainingClient& client,
                                          const std::string& dataset,
                                          Trials trials) {
  TACTUS_RETURN_IF_ERROR(client.CreateDataset(dataset, "").status());
  v1::CreateUploadRequest request;
  request.set_dataset(dataset);
  TACTUS_ASSIGN_OR_RETURN(const v1::FinishUploadResponse made,
                          TrialUploader(&client, {}).Upload(request, [&] {
                            return trials.Next();
                          }));
  return made.version();
}

// A job that trains longer than any measurement.
absl::StatusOr<std::string> BeginTraining(TrainingClient& client,
                                          const std::string& dataset) {
  v1::TrainModelRequest request;
  request.mutable_spec()->set_dataset_version(dataset);
  request.mutable_spec()->set_model(kModel);
  request.mutable_spec()->set_preset("tuned");
  request.mutable_spec()->set_epochs(1000);
  request.mutable_spec()->set_skip_unusable(true);
  TACTUS_ASSIGN_OR_RETURN(const v1::Operation job, client.TrainModel(request));
  return job.name();
}

absl::Status EndTraining(TrainingClient& client, const std::string& job) {
  TACTUS_RETURN_IF_ERROR(client.CancelOperation(job).status());
  OperationWatcher watcher(&client, {});
  return watcher.Watch(job, [](const auto&, auto) {}).status();
}

// Seconds from TrainModel to the first point of a learning curve.
absl::StatusOr<double> FirstIteration(TrainingClient& client,
                                      const std::string& dataset) {
  const auto begin = steady_clock::now();
  TACTUS_ASSIGN_OR_RETURN(const std::string job,
                          BeginTraining(client, dataset));
  std::optional<double> seconds;
  OperationWatcher watcher(&client, {});
  TACTUS_ASSIGN_OR_RETURN(const v1::Operation ended,
                          watcher.Watch(job, [&](const auto&, auto points) {
                            if (seconds || points.empty()) return;
                            seconds = SecondsSince(begin);
                            client.CancelOperation(job).IgnoreError();
                          }));
  if (!seconds) {
    return InvalidResponse("state", v1::Operation::State_Name(ended.state()),
                           "a learning curve before the end");
  }
  return *seconds;
}

// The median of some measurements.
absl::StatusOr<BenchRow> FirstIterations(const std::string& name,
                                         TrainingClient& client,
                                         const std::string& dataset,
                                         int turns) {
  std::vector<double> seconds;
  for (int i = 0; i < turns; ++i) {
    TACTUS_ASSIGN_OR_RETURN(seconds.emplace_back(),
                            FirstIteration(client, dataset));
  }
  return BenchRow{.name = name, .unit = "s", .ours = Percentile(seconds, 0.5)};
}

// Moves the alias between the versions of kModel, evenly over the seconds of a
// measurement.
absl::Status Promote(const TrainingBenchOptions& options) {
  TrainingClient client(MakeTrainingChannel(options.promote_on, {}));
  TACTUS_ASSIGN_OR_RETURN(const auto versions,
                          client.ListModelVersions(kModel));
  if (versions.empty()) {
    return InvalidResponse(kModel, "no versions", "some to promote");
  }
  const auto begin = steady_clock::now();
  for (int i = 0; i < options.activations; ++i) {
    std::this_thread::sleep_until(
        begin +
        std::chrono::duration_cast<steady_clock::duration>(
            duration<double>(options.load.seconds * i / options.activations)));
    v1::PromoteModelRequest request;
    request.mutable_spec()->set_alias(kAlias);
    request.mutable_spec()->set_model_version(
        versions[i % versions.size()].name());
    TACTUS_RETURN_IF_ERROR(client.PromoteModel(request).status());
  }
  return absl::OkStatus();
}

// Promotes in a second process. Calls from this one delay the robots that it
// plays.
absl::StatusOr<pid_t> StartPromotions(const TrainingBenchOptions& options,
                                      const std::string& address) {
  return SpawnBeside("tactus-bench",
                     {"training", absl::StrCat("--promote-on=", address),
                      absl::StrCat("--activations=", options.activations),
                      absl::StrCat("--seconds=", options.load.seconds)});
}

class TrainingBenchmark : public Benchmark {
 public:
  const char* name() const override { return "training"; }
  const char* description() const override {
    return "The training service: uploads, first iteration, streams meanwhile";
  }

  void AddFlags(CLI::App& command) override {
    command.add_option("--data", options_.data,
                       "Trial file; default: simulated signals");
    command.add_option("--server", options_.server,
                       "Further flag of tactusd; may be repeated");
    command
        .add_option("--turns", options_.turns,
                    "Measurements of each state; medians count")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command
        .add_option("--activations", options_.activations,
                    "Promotions during each measurement")
        ->check(CLI::Range(0, 10'000))
        ->capture_default_str();
    command
        .add_option("--seconds", options_.load.seconds, "Of each measurement")
        ->check(CLI::Range(0.1, 1e6))
        ->capture_default_str();
    command.add_option("--promote-on", options_.promote_on,
                       "Only promotes, on this server: the program's own use");
  }

  absl::StatusOr<std::vector<BenchRow>> Run(bool quick) override {
    TrainingBenchOptions options = options_;
    if (!options.promote_on.empty()) {
      TACTUS_RETURN_IF_ERROR(Promote(options));
      return std::vector<BenchRow>();
    }
    size_t simulated = 1835;
    if (quick) {
      simulated = 120;
      options.turns = 1;
      options.activations = 2;
      options.load.robots = 5;
      options.load.seconds = 0.2;
      options.load.warm_up_seconds = 0.05;
    }
    TACTUS_ASSIGN_OR_RETURN(const TemporaryFolder folder,
                            TemporaryFolder::Create());
    const std::string socket = absl::StrCat("unix:", folder.path(), "/socket");
    std::vector<std::string> flags = {
        "--listen=127.0.0.1:0", absl::StrCat("--listen=", socket),
        absl::StrCat("--data-dir=", folder.path(), "/data"),
        "--log-level=error"};
    flags.insert(flags.end(), options.server.begin(), options.server.end());
    TACTUS_ASSIGN_OR_RETURN(const auto server,
                            ChildServer::Start("tactusd", flags));
    options.load.servers = {server->address()};
    TrainingClient client(MakeTrainingChannel(socket, {}));
    TACTUS_ASSIGN_OR_RETURN(Trials trials,
                            Trials::Open(options.data, simulated));
    const auto begin = steady_clock::now();
    TACTUS_ASSIGN_OR_RETURN(const v1::DatasetVersion version,
                            Upload(client, kData, std::move(trials)));
    const double upload_s = SecondsSince(begin);
    std::vector<BenchRow> rows = {
        {.name = "training/upload",
         .unit = "MB/s",
         .ours = static_cast<double>(version.bytes()) / 1e6 / upload_s}};
    TACTUS_ASSIGN_OR_RETURN(rows.emplace_back(),
                            FirstIterations("training/first_iteration", client,
                                            version.name(), options.turns));
    if (!options.data.empty()) {
      TACTUS_ASSIGN_OR_RETURN(Trials signals, Trials::Open("", simulated));
      TACTUS_ASSIGN_OR_RETURN(const v1::DatasetVersion signals_version,
                              Upload(client, kSignals, std::move(signals)));
      TACTUS_ASSIGN_OR_RETURN(
          rows.emplace_back(),
          FirstIterations("training/first_iteration_signals", client,
                          signals_version.name(), options.turns));
    }
    TACTUS_RETURN_IF_ERROR(
        AddStreams(options, socket, client, version.name(), &rows));
    return rows;
  }

 private:
  // The streams' delays while nothing else happens, and, in turns with that,
  // during training and promotions.
  static absl::Status AddStreams(const TrainingBenchOptions& options,
                                 const std::string& socket,
                                 TrainingClient& client,
                                 const std::string& dataset,
                                 std::vector<BenchRow>* rows) {
    TACTUS_ASSIGN_OR_RETURN(const auto model,
                            DecodeBundle(server::DefaultBundle()));
    TACTUS_ASSIGN_OR_RETURN(const std::string bundle,
                            EncodeBundle(model->model()));
    for (int i = 0; i < 2; ++i) {
      TACTUS_RETURN_IF_ERROR(client.ImportModel(kModel, bundle).status());
    }
    TACTUS_ASSIGN_OR_RETURN(const FrameScript script, MakeScript(options.load));
    std::vector<double> idle;
    std::vector<double> busy;
    for (int i = 0; i < options.turns; ++i) {
      TACTUS_ASSIGN_OR_RETURN(idle.emplace_back(), P99(options.load, script));
      TACTUS_ASSIGN_OR_RETURN(const std::string job,
                              BeginTraining(client, dataset));
      TACTUS_ASSIGN_OR_RETURN(const pid_t promotions,
                              StartPromotions(options, socket));
      const auto p99 = P99(options.load, script);
      TACTUS_RETURN_IF_ERROR(AwaitSuccess(promotions, "the promotions"));
      TACTUS_RETURN_IF_ERROR(p99.status());
      busy.push_back(*p99);
      TACTUS_RETURN_IF_ERROR(EndTraining(client, job));
    }
    rows->push_back(
        {.name = absl::StrCat("training/", options.load.robots, "x100_p99"),
         .unit = "ms",
         .ours = Percentile(busy, 0.5),
         .peer = Percentile(idle, 0.5),
         .peer_name = "no training"});
    return absl::OkStatus();
  }

  static absl::StatusOr<double> P99(const LoadOptions& options,
                                    const FrameScript& script) {
    TACTUS_ASSIGN_OR_RETURN(const LoadReport report, RunLoad(options, script));
    if (report.refused + report.failed > 0) {
      return IoError("tactusd", report.first_error);
    }
    return report.p99_ms;
  }

  TrainingBenchOptions options_;
};

}  // namespace

std::unique_ptr<Benchmark> MakeTrainingBenchmark() {
  return std::make_unique<TrainingBenchmark>();
}

}  // namespace tactus::internal::client
