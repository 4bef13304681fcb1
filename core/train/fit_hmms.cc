#include "core/base/status_macros.h"
#include "core/hmm/train_mixture.h"
#include "core/train/fit_models.h"
#include "core/train/inputs.h"

namespace tactus {
namespace {

absl::StatusOr<HmmMixture> FitClass(
    const std::vector<const LabelledContact*>& contacts,
    const std::string& name, const InputSpec& spec, const FitOptions& options) {
  std::vector<std::vector<double>> sequences;
  for (const LabelledContact* contact : contacts) {
    if (contact->label == name) {
      sequences.push_back(MakeSequence(*contact, spec.hmm, spec.hmm_steps));
    }
  }
  const int dimensions = static_cast<int>(spec.hmm.size());
  std::vector<SequenceView> views;
  for (const auto& sequence : sequences) {
    views.push_back({sequence.data(),
                     static_cast<int>(sequence.size()) / dimensions,
                     dimensions});
  }
  TrainMixtureOptions training;
  training.components = options.hmms_per_class;
  training.states = options.states;
  training.baum_welch.max_iterations = options.max_iterations;
  training.baum_welch.covariance_floor = options.covariance_floor;
  training.baum_welch.seed = options.seed;
  TACTUS_ASSIGN_OR_RETURN(TrainedMixture trained,
                          TrainMixture(views, training));
  return std::move(trained.mixture);
}

}  // namespace

absl::StatusOr<Model> FitHmms(
    const std::vector<const LabelledContact*>& contacts,
    const std::vector<std::string>& class_names, const FitOptions& options,
    const Progress& progress) {
  Model model;
  model.class_names = class_names;
  model.inputs.hmm_steps = options.hmm_steps;
  model.inputs.hmm = FitInputs(
      contacts, CuesFor(options.hmm_cues, options.features),
      {.log_features = options.log_features, .steps = options.hmm_steps});
  model.inputs.sample_rate_hz = contacts.front()->sample_rate_hz;
  model.hmm_score = options.score;
  model.layout = contacts.front()->layout;
  for (const std::string& name : class_names) {
    TACTUS_ASSIGN_OR_RETURN(HmmMixture mixture,
                            FitClass(contacts, name, model.inputs, options));
    model.hmms.push_back(std::move(mixture));
    progress.Add(1 / static_cast<double>(class_names.size()));
  }
  Calibration& c = model.calibration;
  c.frames = {1};
  c.hmm_inverse_temperature = {1};
  c.evidence_median = {0};
  c.evidence_deviation = {1};
  c.prior.assign(class_names.size(),
                 1.0 / static_cast<double>(class_names.size()));
  return model;
}

}  // namespace tactus
