// trainctl train: trains a model on a server.
#include <iostream>

#include "absl/strings/str_cat.h"
#include "client/training/retry.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/train/fit_options.h"
#include "tools/trainctl/fit/spec_flags.h"
#include "tools/trainctl/remote/flags.h"
#include "tools/trainctl/remote/job.h"

namespace tactus::internal::client {
namespace {

struct RemoteTrainFlags {
  std::string dataset;
  std::string model;
  std::string from;
  SpecFlags spec;
  // Those that `spec` added; the command owns them.
  std::vector<const CLI::Option*> spec_options;
  bool skip_unusable = false;
  std::string note;
  bool detach = false;
  bool check = false;
};

// How a version was trained, with what was chosen for it then, so that nothing
// has to be compared again.
absl::StatusOr<v1::TrainSpec> SpecOfVersion(TrainingClient& client,
                                            const RemoteTrainFlags& flags) {
  for (const CLI::Option* option : flags.spec_options) {
    if (option->count() == 0) continue;
    return InvalidConfig(option->get_name(), "given with --from",
                         "absent: --from says how to train");
  }
  TACTUS_ASSIGN_OR_RETURN(
      const v1::ModelVersion version,
      client.GetModelVersion(FullName("models", flags.from)));
  if (!version.has_train()) {
    return InvalidConfig("--from", flags.from,
                         "a version that the server has trained");
  }
  v1::TrainSpec spec = version.train();
  if (!spec.preset().empty() && spec.preset() != kAutoPreset) return spec;
  const auto job = client.GetOperation(version.operation());
  if (!job.ok()) {
    return Advise(job.status(),
                  absl::StrCat("the job that chose the preset of ", flags.from,
                               " is needed; without it, name a preset in the "
                               "place of --from"));
  }
  if (!job->result().has_preset_choice()) {
    spec.set_preset("tuned");
    return spec;
  }
  const v1::PresetChoice& choice = job->result().preset_choice();
  spec.set_preset(choice.preset());
  spec.set_networks(choice.networks());
  spec.clear_choice_work();
  return spec;
}

absl::StatusOr<v1::TrainSpec> TrainSpecOfFlags(TrainingClient& client,
                                               const RemoteTrainFlags& flags) {
  TACTUS_ASSIGN_OR_RETURN(v1::TrainSpec spec,
                          flags.from.empty() ? TrainSpecOf(flags.spec)
                                             : SpecOfVersion(client, flags));
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
  command->add_option("--from", flags->from,
                      "Train as this version was, like arm@3, with the preset "
                      "that was chosen for it: for a dataset with more trials "
                      "or with another class");
  flags->spec_options = flags->spec.Add(*command);
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
      "  trainctl train --dataset=arm@2 --model=arm --preset=tuned --seed=7\n"
      "  trainctl train --dataset=arm --model=arm --from=arm@3");
  AddRemoteCommand(*command, select,
                   [=](TrainingClient& client, const RemoteFlags& remote) {
                     return RunRemoteTrain(client, remote, *flags);
                   });
}

}  // namespace tactus::internal::client
