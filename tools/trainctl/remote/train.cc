// trainctl train: trains a model on a server.
#include <iostream>

#include "absl/strings/str_cat.h"
#include "client/training/retry.h"
#include "core/base/status_macros.h"
#include "tools/trainctl/remote/flags.h"
#include "tools/trainctl/remote/job.h"
#include "tools/trainctl/remote/spec.h"

namespace tactus::client {
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
  command->add_option("--preset", flags->spec.preset,
                      "auto, tuned, world, paper, pattern, whole-skin or "
                      "profile; default: auto for a skin without poses, else "
                      "tuned");
  command->add_option("--choice-work", flags->spec.choice_work,
                      "With preset auto: work that LSTMs may cost while "
                      "presets are compared, in billions of multiplications; "
                      "0 compares HMMs alone; default: 1,000");
  command->add_option("--features", flags->spec.features,
                      "Features that models may use: any of f (force), m "
                      "(motion), a (area), like f,m");
  command->add_option("--truth", flags->spec.truth,
                      "What answers are about: final (the class in the end) "
                      "or so-far (unmoved until the object has moved), instead "
                      "of the preset's");
  command->add_option("--shares", flags->spec.shares,
                      "Prior of the classes in calibrated answers: "
                      "recorded (as among the trials; the default) or even");
  command->add_option("--seed", flags->spec.seed, "Seed of every random choice")
      ->capture_default_str();
  command->add_option("--networks", flags->spec.networks,
                      "Number of LSTMs, instead of the preset's; 0 for none");
  command->add_option("--epochs", flags->spec.epochs,
                      "Epochs of LSTM training, instead of the preset's");
  command->add_option("--hmms-per-class", flags->spec.hmms_per_class,
                      "HMMs per class, instead of the preset's");
  command->add_option("--with-cues", flags->spec.with_cues,
                      "Cues that the LSTMs take beside the preset's, like "
                      "force_pitch_short");
  command->add_option("--without-cues", flags->spec.without_cues,
                      "Cues that neither HMMs nor LSTMs take, like log_drag");
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

}  // namespace tactus::client
