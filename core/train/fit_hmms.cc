#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/hmm/train_mixture.h"
#include "core/inputs/inputs.h"
#include "core/train/fit_models.h"

namespace tactus {
namespace {

// Number of steps up to the last frame at which the object is unmoved so far.
size_t StepsBeforeMotion(const LabelledContact& contact,
                         const StepIntervals& steps) {
  size_t count = 0;
  WalkCues(contact, steps, /*groups=*/0, nullptr,
           [&](CueTracker&, size_t frame) {
             count += contact.object_motion[frame] <= kMovedM;
           });
  return count;
}

}  // namespace

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
  const int dimensions = static_cast<int>(spec.hmm.size());
  const bool so_far = run.options.truth == Truth::kSoFar;
  std::vector<std::vector<double>> sequences;
  LabelledContact made;
  for (size_t i = 0; i < contacts.size(); ++i) {
    const LabelledContact& original = contacts.Original(i);
    const std::string& name = run.class_names[label];
    const bool ends_so = original.label == name;
    if (!ends_so && !(so_far && LabelSoFar(original, 0) == name)) continue;
    const LabelledContact& contact = contacts.Get(i, made);
    sequences.push_back(
        MakeSequence(contact, spec.hmm, spec.hmm_steps, &spec.embedding));
    // Of a contact that only begins in this class, the beginning.
    if (!ends_so) {
      sequences.back().resize(dimensions *
                              StepsBeforeMotion(contact, spec.hmm_steps));
    }
    // A copy may be too short for a step.
    if (sequences.back().empty()) sequences.pop_back();
  }
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
