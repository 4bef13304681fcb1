// trainctl evaluate --dataset: measures accuracy on a server.
#include <set>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/training/retry.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "tools/trainctl/exit_code.h"
#include "tools/trainctl/fit/spec_flags.h"
#include "tools/trainctl/remote/flags.h"
#include "tools/trainctl/remote/job.h"
#include "tools/trainctl/remote/report.h"
#include "tools/trainctl/verbs.h"

namespace tactus::internal::client {
namespace {

struct RemoteEvaluateFlags {
  std::string dataset;
  bool detach = false;
  RemoteFlags remote;
};

// The protocols of a server, by the names that `evaluate` has for files, too.
const std::set<std::string> kProtocols = {"loco", "leave-one-material-out",
                                          "leave-one-out", "k-fold"};

// RemoteEvaluateFlags of `evaluate` that a server can follow.
const std::set<std::string> kKnown = {
    "--help",           "--dataset",         "--model",
    "--protocol",       "--preset",          "--choice-work",
    "--features",       "--truth",           "--shares",
    "--seed",           "--networks",        "--epochs",
    "--hmms-per-class", "--with-cues",       "--without-cues",
    "--json",           "--gradient-shards", "--report",
    "--detach",         "--server",          "--tls-ca",
    "--token-file"};

// The value of a flag; nothing if it was not given.
template <typename Value>
std::optional<Value> Given(const CLI::App& command, const char* flag) {
  const CLI::Option* option = command.get_option(flag);
  if (option->count() == 0) return std::nullopt;
  return option->as<Value>();
}

absl::Status Usage(const std::string& flag, const std::string& got,
                   const std::string& want) {
  return WithExitCode(InvalidConfig(flag, got, want), kExitUsage);
}

SpecFlags SpecFlagsOf(const CLI::App& command) {
  const auto text = [&](const char* flag) {
    return Given<std::string>(command, flag).value_or("");
  };
  return {.preset = text("--preset"),
          .features = text("--features"),
          .truth = text("--truth"),
          .shares = text("--shares"),
          .seed = Given<uint64_t>(command, "--seed").value_or(1),
          .networks = Given<int>(command, "--networks"),
          .epochs = Given<int>(command, "--epochs"),
          .gradient_shards = Given<int>(command, "--gradient-shards"),
          .hmms_per_class = Given<int>(command, "--hmms-per-class"),
          .choice_work = Given<int>(command, "--choice-work"),
          .with_cues = text("--with-cues"),
          .without_cues = text("--without-cues")};
}

absl::StatusOr<v1::EvaluateSpec> EvaluateSpecOf(
    TrainingClient& client, const CLI::App& command,
    const RemoteEvaluateFlags& flags) {
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() > 0 && !kKnown.contains(option->get_name())) {
      return Usage(option->get_name(), "given with --dataset",
                   "absent: a server does not know it");
    }
  }
  const auto model = Given<std::string>(command, "--model");
  const auto protocol = Given<std::string>(command, "--protocol");
  if (model.has_value() == protocol.has_value()) {
    return Usage("--protocol and --model", model ? "both given" : "both absent",
                 "exactly one of the two");
  }
  v1::EvaluateSpec spec;
  TACTUS_ASSIGN_OR_RETURN(
      const v1::DatasetVersion version,
      client.GetDatasetVersion(FullName("datasets", flags.dataset)));
  spec.set_dataset_version(version.name());
  if (protocol) {
    if (!kProtocols.contains(*protocol)) {
      return Usage("--protocol", *protocol,
                   "loco, leave-one-material-out, leave-one-out or k-fold on "
                   "a server");
    }
    spec.set_protocol(*protocol);
    TACTUS_ASSIGN_OR_RETURN(*spec.mutable_train(),
                            TrainSpecOf(SpecFlagsOf(command)));
    spec.mutable_train()->set_dataset_version(version.name());
    return spec;
  }
  if (absl::StartsWith(*model, "aliases/")) {
    spec.set_model_version(*model);
    return spec;
  }
  TACTUS_ASSIGN_OR_RETURN(const v1::ModelVersion found,
                          client.GetModelVersion(FullName("models", *model)));
  spec.set_model_version(found.name());
  return spec;
}

absl::Status RunRemoteEvaluate(TrainingClient& client, const CLI::App& command,
                               const RemoteEvaluateFlags& flags) {
  const auto report = Given<std::string>(command, "--report");
  if (report && flags.detach) {
    return Usage("--report", "given with --detach",
                 "absent: there is no result yet");
  }
  if (report) TACTUS_RETURN_IF_ERROR(MakeFolder(*report));
  v1::EvaluateModelRequest request;
  TACTUS_ASSIGN_OR_RETURN(*request.mutable_spec(),
                          EvaluateSpecOf(client, command, flags));
  request.set_request_id(NewRequestId());
  TACTUS_ASSIGN_OR_RETURN(const v1::Operation job, Repeated({}, [&] {
                            return client.EvaluateModel(request);
                          }));
  if (flags.detach) {
    PrintJob(job, flags.remote);
    return absl::OkStatus();
  }
  TACTUS_RETURN_IF_ERROR(FollowJob(client, flags.remote, job));
  if (!report) return absl::OkStatus();
  TACTUS_ASSIGN_OR_RETURN(const v1::Operation ended, Repeated({}, [&] {
                            return client.GetOperation(job.name());
                          }));
  return WriteRemoteReport(*report, ended);
}

}  // namespace

void AddRemoteEvaluate(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<RemoteEvaluateFlags>();
  AddEvaluate(app, [&app, flags, select](Command local) {
    if (flags->dataset.empty()) {
      select(std::move(local));
      return;
    }
    select([&app, flags] {
      const CLI::App& command = *app.get_subcommand("evaluate");
      flags->remote.json = command.get_option("--json")->count() > 0;
      return RunRemote(flags->remote,
                       [&](TrainingClient& client, const RemoteFlags&) {
                         return RunRemoteEvaluate(client, command, *flags);
                       });
    });
  });
  CLI::App& command = *app.get_subcommand("evaluate");
  command
      .add_option("--dataset", flags->dataset,
                  "Dataset on a server, or a version like arm@2, instead of "
                  "--data; --model is then a model on the server")
      ->excludes(command.get_option("--data"));
  command.add_flag("--detach", flags->detach,
                   "With --dataset: return at once; the job runs on");
  flags->remote.AddServer(command);
  command.footer(
      "Examples:\n"
      "  trainctl evaluate --data=trials.h5 --model=arm.tactus\n"
      "  trainctl evaluate --dataset=arm@2 --model=arm@3\n"
      "  trainctl evaluate --dataset=arm --protocol=loco --preset=paper");
}

}  // namespace tactus::internal::client
