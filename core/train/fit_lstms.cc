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

absl::StatusOr<LstmNetwork> Train(const LstmFit& fit, uint64_t seed, int inputs,
                                  int classes, int regressions,
                                  std::span<const LstmSequence> sequences,
                                  const Progress& progress) {
  LstmTrainOptions training = fit.training;
  training.seed = seed;
  const LstmNetwork start =
      RandomNetwork(inputs, fit.cells, classes, fit.activation,
                    fit.gate_activation, seed, /*forget_bias=*/1, regressions);
  TACTUS_ASSIGN_OR_RETURN(
      LstmTrained trained,
      TrainLstm({.network = start}, sequences, {}, training,
                [&](const LstmEpoch&, const LstmCheckpoint&) {
                  progress.Add(1.0 / training.epochs);
                  return absl::OkStatus();
                }));
  return std::move(trained.network);
}

}  // namespace

absl::Status FitLstms(const std::vector<const LabelledContact*>& contacts,
                      const FitOptions& options, int networks,
                      const ParallelFor& parallel, const Progress& progress,
                      Model& model) {
  const LstmFit& fit = options.lstm;
  InputSpec& spec = model.inputs;
  spec.lstm_steps = fit.steps;
  spec.lstm = FitInputs(
      contacts, CuesFor(fit.cues, options.features),
      {.scaling = fit.scaling, .steps = fit.steps, .limit = fit.limit});
  if (fit.stretches > 0) {
    const auto stretches =
        FitStretches(contacts, CuesFor(fit.stretched_cues, options.features),
                     fit.stretches, fit.steps);
    spec.lstm.insert(spec.lstm.end(), stretches.begin(), stretches.end());
  }
  const int inputs = static_cast<int>(spec.lstm.size());

  // The estimator is trained where the truth is known.
  const bool estimate =
      fit.estimates && std::all_of(contacts.begin(), contacts.end(),
                                   [](const LabelledContact* c) {
                                     return c->stiffness > 0 &&
                                            !c->object_motion.empty();
                                   });
  std::vector<std::vector<float>> rows;
  std::vector<std::vector<float>> targets;
  std::vector<LstmSequence> sequences;
  std::vector<LstmSequence> with_targets;
  for (const LabelledContact* contact : contacts) {
    rows.push_back(MakeLstmSequence(*contact, spec.lstm, fit.steps));
    if (rows.back().empty()) continue;
    const auto label = std::find(model.class_names.begin(),
                                 model.class_names.end(), contact->label);
    sequences.push_back(
        {.inputs = rows.back(),
         .label = static_cast<int>(label - model.class_names.begin())});
    if (!estimate) continue;
    targets.push_back(MakeTargets(*contact, fit.steps));
    with_targets.push_back(sequences.back());
    with_targets.back().targets = targets.back();
  }

  std::vector<absl::StatusOr<LstmNetwork>> trained(
      networks + (estimate ? 1 : 0),
      absl::StatusOr<LstmNetwork>(LstmNetwork()));
  parallel(static_cast<int>(trained.size()), [&](int n) {
    const bool estimator = n == networks;
    trained[n] =
        Train(fit, options.seed + static_cast<uint64_t>(n), inputs,
              model.classes(), estimator ? kEstimateRegressions : 0,
              estimator ? with_targets : sequences,
              progress.Part("", 1 / static_cast<double>(trained.size())));
  });
  for (const auto& network : trained) {
    TACTUS_RETURN_IF_ERROR(network.status());
  }
  if (estimate) {
    model.estimator = *std::move(trained.back());
    trained.pop_back();
  }
  for (auto& network : trained) model.lstms.push_back(*std::move(network));
  model.calibration.lstm_inverse_temperature.assign(
      model.calibration.frames.size(), 1);
  model.calibration.lstm_weight.assign(model.calibration.frames.size(), 0.5);
  return absl::OkStatus();
}

}  // namespace tactus
