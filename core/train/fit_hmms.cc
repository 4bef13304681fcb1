#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/hmm/train_mixture.h"
#include "core/train/fit_models.h"
#include "core/train/inputs.h"

namespace tactus {

absl::StatusOr<HmmMixture> FitClassHmms(const FitRun& run,
                                        const std::string& part,
                                        const VariedContacts& contacts,
                                        const InputSpec& spec, int label,
                                        const Progress& progress) {
  TACTUS_ASSIGN_OR_RETURN(auto saved, run.saved.Find<HmmMixture>(part));
  if (saved) {
    progress.Add(1);
    return *std::move(saved);
  }
  std::vector<std::vector<double>> sequences;
  LabelledContact made;
  for (size_t i = 0; i < contacts.size(); ++i) {
    if (contacts.Original(i).label != run.class_names[label]) continue;
    sequences.push_back(
        MakeSequence(contacts.Get(i, made), spec.hmm, spec.hmm_steps));
    // A copy may be too short for a step.
    if (sequences.back().empty()) sequences.pop_back();
  }
  const int dimensions = static_cast<int>(spec.hmm.size());
  std::vector<SequenceView> views;
  for (const auto& sequence : sequences) {
    views.push_back({sequence.data(),
                     static_cast<int>(sequence.size()) / dimensions,
                     dimensions});
  }
  const FitOptions& options = run.options;
  TrainMixtureOptions training;
  training.components = options.hmms_per_class;
  training.states = options.states;
  training.baum_welch.max_iterations = options.max_iterations;
  training.baum_welch.covariance_floor = options.covariance_floor;
  training.baum_welch.seed = options.seed;
  TACTUS_ASSIGN_OR_RETURN(
      TrainedMixture trained,
      TrainMixture(
          views, training, [&](int component, const BaumWelchReport& report) {
            run.Report({.phase = "fit HMMs",
                        .part = absl::StrCat(part, "/", component),
                        .iteration = report.iterations,
                        .max_iterations = options.max_iterations,
                        .log_likelihood = report.log_likelihood.back()});
            return run.GoOn();
          }));
  TACTUS_RETURN_IF_ERROR(run.saved.Put(part, trained.mixture));
  progress.Add(1);
  return std::move(trained.mixture);
}

}  // namespace tactus
