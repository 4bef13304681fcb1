#include <algorithm>

#include "core/base/status_macros.h"
#include "core/classify/object_estimate.h"
#include "core/train/fit_models.h"
#include "core/train/inputs.h"

namespace tactus {
namespace {

// What object_estimate.h asks for, at every step.
std::vector<float> MakeTargets(const LabelledContact& contact,
                               const StepIntervals& steps) {
  std::vector<float> targets;
  WalkCues(contact, steps, [&](CueTracker& cues, size_t frame) {
    targets.push_back(static_cast<float>(EncodeStiffness(contact.stiffness)));
    targets.push_back(static_cast<float>(
        EncodeMoved(contact.object_motion[frame], cues.value(Cue::kMotion))));
  });
  return targets;
}

}  // namespace

LstmInputs MakeLstmInputs(const FitRun& run, const VariedContacts& contacts,
                          const InputSpec& spec, bool with_targets) {
  LstmInputs inputs;
  LabelledContact made;
  for (size_t i = 0; i < contacts.size(); ++i) {
    const LabelledContact& contact = contacts.Get(i, made);
    inputs.rows.push_back(
        MakeLstmSequence(contact, spec.lstm, spec.lstm_steps));
    if (inputs.rows.back().empty()) continue;
    const auto label = std::find(run.class_names.begin(), run.class_names.end(),
                                 contact.label);
    inputs.sequences.push_back(
        {.inputs = inputs.rows.back(),
         .label = static_cast<int>(label - run.class_names.begin())});
    if (!with_targets) continue;
    inputs.targets.push_back(MakeTargets(contact, spec.lstm_steps));
    inputs.with_targets.push_back(inputs.sequences.back());
    inputs.with_targets.back().targets = inputs.targets.back();
  }
  return inputs;
}

absl::StatusOr<LstmNetwork> FitLstm(const FitRun& run, const std::string& part,
                                    const LstmInputs& inputs,
                                    const InputSpec& spec, int n,
                                    bool estimates, const Progress& progress) {
  const LstmFit& fit = run.options.lstm;
  LstmTrainOptions training = fit.training;
  training.seed = run.options.seed + static_cast<uint64_t>(n);
  TACTUS_ASSIGN_OR_RETURN(auto from, run.saved.Find<LstmCheckpoint>(part));
  if (!from) {
    from = LstmCheckpoint{
        .network = RandomNetwork(static_cast<int>(spec.lstm.size()), fit.cells,
                                 static_cast<int>(run.class_names.size()),
                                 fit.activation, fit.gate_activation,
                                 training.seed, /*forget_bias=*/1,
                                 estimates ? kEstimateRegressions : 0)};
  }
  progress.Add(static_cast<double>(from->history.size()) / training.epochs);
  TACTUS_ASSIGN_OR_RETURN(
      LstmTrained trained,
      TrainLstm(
          *std::move(from), estimates ? inputs.with_targets : inputs.sequences,
          {}, training,
          [&](const LstmEpoch& epoch, const LstmCheckpoint& state) {
            progress.Add(1.0 / training.epochs);
            run.Report({.phase = "train LSTMs",
                        .part = part,
                        .iteration = epoch.epoch,
                        .max_iterations = training.epochs,
                        .loss = epoch.train_loss,
                        .accuracy = epoch.train_accuracy});
            return run.saved.Put(part, state);
          },
          [&] { return run.GoOn(); }));
  return std::move(trained.network);
}

}  // namespace tactus
