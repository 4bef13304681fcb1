// tactus-worker: runs the jobs of a catalogue that servers share, and serves
// nothing.
#include <cstdio>
#include <map>
#include <string>

#include "CLI/CLI.hpp"
#include "core/base/arguments.h"
#include "core/base/status_macros.h"
#include "core/base/version.h"
#include "core/postgres/pg_connection.h"
#include "server/jobs/training_backend.h"
#include "server/ops/logging.h"
#include "server/ops/service_notify.h"
#include "server/ops/signals.h"
#include "server/registry/default_bundle.h"
#include "server/registry/model_registry.h"
#include "server/training_flags.h"
#include "spdlog/spdlog.h"

namespace tactus::internal::server {
namespace {

struct WorkerFlags {
  TrainingFlags training;
  std::string log_level = "info";
  LogFormat log_format = LogFormat::kText;
};

void NotifyManager(absl::string_view state) {
  const absl::Status status = NotifyService(state);
  if (!status.ok()) spdlog::warn("systemd: {}", std::string(status.message()));
}

absl::Status Work(const WorkerFlags& flags, StopSignals& signals) {
  TACTUS_RETURN_IF_ERROR(StartLogging(flags.log_level, flags.log_format));
  TACTUS_RETURN_IF_ERROR(flags.training.Check());
  // Jobs evaluate the built-in models too.
  ModelRegistry registry;
  TACTUS_RETURN_IF_ERROR(registry.AddBuiltIn("default", DefaultBundle()));
  TACTUS_RETURN_IF_ERROR(registry.AddBuiltIn("no-poses", NoPosesBundle()));
  TACTUS_ASSIGN_OR_RETURN(
      const auto backend,
      TrainingBackend::Open(flags.training.Options(/*address=*/""), &registry));
  backend->Start();
  spdlog::info("{} of {}, folder {}: waits for jobs",
               backend->replica()->name(), ShownAddress(flags.training.catalog),
               flags.training.blobs);
  NotifyManager("READY=1");
  const int signal = signals.Wait();
  NotifyManager("STOPPING=1");
  spdlog::info("signal {}: another one goes on with its jobs", signal);
  backend->Stop();
  return absl::OkStatus();
}

int WorkerMain(int argc, char** argv) {
  WorkerFlags flags;
  CLI::App app(
      "Tactus worker: runs the trainings and evaluations of servers "
      "that share a catalogue.",
      "tactus-worker");
  app.set_version_flag("--version", std::string("tactus-worker ") + kVersion);
  flags.training.AddCatalog(app);
  app.get_option("--catalog")->required();
  flags.training.AddJobs({"local", "slurm"}, app);
  app.add_option("--log-level", flags.log_level,
                 "trace, debug, info, warn, error or off")
      ->capture_default_str();
  app.add_option("--log-format", flags.log_format, "text or json")
      ->transform(CLI::CheckedTransformer(std::map<std::string, LogFormat>{
          {"text", LogFormat::kText}, {"json", LogFormat::kJson}}))
      ->default_str("text");
  if (const absl::Status status = CheckArguments(argc, argv); !status.ok()) {
    std::fprintf(stderr, "tactus-worker: %s\n",
                 std::string(status.message()).c_str());
    return 1;
  }
  CLI11_PARSE(app, argc, argv);
  StopSignals signals;
  const absl::Status status = Work(flags, signals);
  if (status.ok()) return 0;
  std::fprintf(stderr, "tactus-worker: %s\n",
               std::string(status.message()).c_str());
  return 1;
}

}  // namespace
}  // namespace tactus::internal::server

int main(int argc, char** argv) {
  return tactus::internal::server::WorkerMain(argc, argv);
}
