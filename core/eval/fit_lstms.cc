#include "core/eval/fit_lstms.h"

#include <algorithm>

#include "core/base/status_macros.h"
#include "core/eval/inputs.h"

namespace tactus {

absl::Status FitLstms(const std::vector<const Contact*>& contacts,
                      const FitOptions& options, int networks,
                      const ParallelFor& parallel, Model& model) {
  const LstmFit& fit = options.lstm;
  FeatureSpec& spec = model.features;
  spec.lstm_steps = fit.steps;
  spec.lstm = FitInputs(contacts, CuesFor(fit.cues, options.features),
                        {.scaling = fit.scaling, .steps = fit.steps});
  const int inputs = static_cast<int>(spec.lstm.size());

  std::vector<std::vector<float>> rows;
  std::vector<LstmSequence> sequences;
  for (const Contact* contact : contacts) {
    rows.push_back(MakeLstmSequence(*contact, spec.lstm, fit.steps));
    if (rows.back().empty()) continue;
    const auto label = std::find(model.class_names.begin(),
                                 model.class_names.end(), contact->label);
    sequences.push_back(
        {.inputs = rows.back(),
         .label = static_cast<int>(label - model.class_names.begin())});
  }

  model.lstms.resize(networks);
  std::vector<absl::Status> failures(networks);
  parallel(networks, [&](int n) {
    const uint64_t seed = options.seed + static_cast<uint64_t>(n);
    LstmTrainOptions training = fit.training;
    training.seed = seed;
    const LstmNetwork start =
        RandomNetwork(inputs, fit.cells, model.classes(), fit.activation,
                      fit.gate_activation, seed);
    auto trained = TrainLstm({.network = start}, sequences, {}, training);
    if (trained.ok()) {
      model.lstms[n] = std::move(trained->network);
    } else {
      failures[n] = trained.status();
    }
  });
  for (const absl::Status& failure : failures) {
    TACTUS_RETURN_IF_ERROR(failure);
  }
  model.calibration.lstm_temperature.assign(model.calibration.frames.size(), 1);
  model.calibration.lstm_weight.assign(model.calibration.frames.size(), 0.5);
  return absl::OkStatus();
}

}  // namespace tactus
