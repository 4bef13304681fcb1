#include "core/base/status_macros.h"
#include "core/classify/object_estimate.h"
#include "core/train/fit_models.h"

namespace tactus::internal {
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
        .network = RandomNetwork(static_cast<int>(spec.lstm.size()),
                                 estimates ? fit.estimator_cells : fit.cells,
                                 static_cast<int>(run.class_names.size()),
                                 fit.activation, fit.gate_activation,
                                 training.seed, /*forget_bias=*/1,
                                 estimates ? kEstimateRegressions : 0)};
  }
  const bool sharded = training.shards > 1 && run.ranks.size() > 1;
  // What all ranks make, the first one reports.
  const bool reports = !sharded || run.IsFirst();
  if (reports) {
    progress.Add(static_cast<double>(from->history.size()) / training.epochs);
  }
  const auto source = inputs.Source(estimates);
  TACTUS_ASSIGN_OR_RETURN(
      LstmTrained trained,
      TrainLstm(
          *std::move(from), *source, {}, training,
          [&](const LstmEpoch& epoch, const LstmCheckpoint& state) {
            if (!reports) return absl::OkStatus();
            progress.Add(1.0 / training.epochs);
            run.Report({.phase = "train LSTMs",
                        .part = part,
                        .iteration = epoch.epoch,
                        .max_iterations = training.epochs,
                        .loss = epoch.train_loss,
                        .accuracy = epoch.train_accuracy});
            return run.saved.Put(part, state);
          },
          [&] { return run.GoOn(); }, sharded ? &run.ranks : nullptr));
  return std::move(trained.network);
}

}  // namespace tactus::internal
