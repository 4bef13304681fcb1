// trainctl train: trains a model on a server.
#include <iostream>

#include "absl/strings/str_cat.h"
#include "client/training/retry.h"
#include "core/base/status_macros.h"
#include "tools/trainctl/fit/spec_flags.h"
#include "tools/trainctl/remote/flags.h"
#include "tools/trainctl/remote/job.h"

namespace tactus::internal::client {
namespace {

struct RemoteTrainFlags {
  std::string dataset;
  std::string model;
  SpecFlags spec;
  bool skip_unusable = false;
  std::string note;
  bool detach = false;
  bool check = false;
};

absl::StatusOr<v1::TrainSpec> TrainSpecOfFlags(TrainingClient& client,
                                               const RemoteTrainFlags& flags) {
  TACTUS_ASSIGN_OR_RETURN(v1::TrainSpec spec, TrainSpecOf(flags.spec));
  TACTUS_ASSIGN_OR_RETURN(
      const v1::DatasetVersion version,
      client.GetDatasetVersion(FullName("datasets", flags.dataset)));
  spec.set_dataset_version(version.name());
  spec.set_model(FullName("models", flags.model));
  spec.set_skip_unusable(flags.skip_unusable);
  spec.set_note(flags.note);
  return spec;
}

absl::Status RunRemoteTrain(TrainingClient& client, const RemoteFlags& remote,
                            const RemoteTrainFlags& flags) {
  v1::TrainModelRequest request;
  TACTUS_ASSIGN_OR_RETURN(*request.mutable_spec(),
                          TrainSpecOfFlags(client, flags));
  request.set_request_id(NewRequestId());
  request.set_validate_only(flags.check);
  TACTUS_ASSIGN_OR_RETURN(const v1::Operation job, Repeated({}, [&] {
                            return client.TrainModel(request);
                          }));
  if (flags.check) {
    if (!remote.json) std::cout << "the request is right\n";
    return absl::OkStatus();
  }
  if (flags.detach) {
    PrintJob(job, remote);
    return absl::OkStatus();
  }
  return FollowJob(client, remote, job);
}

}  // namespace

void AddTrain(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<RemoteTrainFlags>();
  CLI::App* command = app.add_subcommand(
      "train", "Train a model on a server, and watch it being trained");
  command
      ->add_option("--dataset", flags->dataset,
                   "Dataset on the server, or a version like arm@2")
      ->required();
  command
      ->add_option("--model", flags->model,
                   "Model that gets a new version; it may be new")
      ->required();
  flags->spec.Add(*command);
  command->add_flag("--skip-unusable", flags->skip_unusable,
                    "Leave out trials that a model cannot use, instead of "
                    "refusing the dataset");
  command->add_option("--note", flags->note, "Text to keep with the model");
  command->add_flag("--detach", flags->detach,
                    "Return at once; the job runs on");
  command->add_flag("--validate-only", flags->check,
                    "Check the request, and train nothing");
  command->footer(
      "Ctrl-C ends the watch, not the job.\n"
      "Exit codes: 3 the job failed, 4 it was cancelled.\n"
      "Example:\n"
      "  trainctl train --dataset=arm@2 --model=arm --preset=tuned --seed=7");
  AddRemoteCommand(*command, select,
                   [=](TrainingClient& client, const RemoteFlags& remote) {
                     return RunRemoteTrain(client, remote, *flags);
                   });
}

}  // namespace tactus::internal::client
