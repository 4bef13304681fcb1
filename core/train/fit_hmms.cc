#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/hmm/train_mixture.h"
#include "core/inputs/inputs.h"
#include "core/train/fit_models.h"

namespace tactus::internal {
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

// Appends what AppendSequence would make of a contact.
void AppendKept(const CueTable& table, size_t contact,
                std::span<const ModelInput> inputs, std::vector<double>& rows) {
  for (size_t step = 0; step < table.steps(contact); ++step) {
    const std::span<const double> cues = table.values(contact, step);
    for (size_t i = 0; i < inputs.size(); ++i) {
      rows.push_back(ScaleCue(inputs[i], cues[i]));
    }
  }
}

}  // namespace

absl::StatusOr<HmmMixture> FitClassHmms(
    const FitRun& run, const std::string& part, const VariedContacts& contacts,
    const InputSpec& spec, const CueTable& table, int label,
    const ParallelFor& parallel, const Progress& progress) {
  TACTUS_ASSIGN_OR_RETURN(auto saved, run.saved.Find<HmmMixture>(part));
  if (saved) {
    progress.Add(1);
    return *std::move(saved);
  }
  const int dimensions = static_cast<int>(spec.hmm.size());
  const auto begins_so = [&](const LabelledContact& contact) {
    return run.options.truth == Truth::kSoFar &&
           LabelSoFar(contact, 0) == run.class_names[label];
  };
  const auto ends_so = [&](const LabelledContact& contact) {
    return contact.label == run.class_names[label];
  };
  // All sequences lie in one array, whose memory is returned when it is
  // dropped; that of many small ones is not. A copy has at most as many frames.
  std::vector<double> rows;
  size_t steps = 0;
  for (size_t i = 0; i < contacts.size(); ++i) {
    const LabelledContact& original = contacts.Original(i);
    if (!ends_so(original) && !begins_so(original)) continue;
    steps += CountSteps(original, spec.hmm_steps);
  }
  rows.reserve(steps * dimensions);
  std::vector<int> lengths;
  LabelledContact made;
  for (size_t i = 0; i < contacts.size(); ++i) {
    const LabelledContact& original = contacts.Original(i);
    const bool whole = ends_so(original);
    if (!whole && !begins_so(original)) continue;
    const size_t begin = rows.size();
    if (whole && table.kept()) {
      AppendKept(table, i, spec.hmm, rows);
    } else {
      const LabelledContact& contact = contacts.Get(i, made);
      AppendSequence(contact, spec.hmm, spec.hmm_steps, &spec.embedding, rows);
      // A contact that only begins in this class gives its beginning.
      if (!whole) {
        rows.resize(begin +
                    dimensions * StepsBeforeMotion(contact, spec.hmm_steps));
      }
    }
    // A copy may be too short for a step.
    if (rows.size() == begin) continue;
    lengths.push_back(static_cast<int>((rows.size() - begin) / dimensions));
  }
  std::vector<SequenceView> views;
  const double* next = rows.data();
  for (const int length : lengths) {
    views.push_back({next, length, dimensions});
    next += static_cast<size_t>(length) * dimensions;
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
          views, training,
          [&](int component, const BaumWelchReport& report) {
            run.Report({.phase = "fit HMMs",
                        .part = absl::StrCat(part, "/", component),
                        .iteration = report.iterations,
                        .max_iterations = options.max_iterations,
                        .log_likelihood = report.log_likelihood.back()});
            return run.GoOn();
          },
          parallel));
  TACTUS_RETURN_IF_ERROR(run.saved.Put(part, trained.mixture));
  progress.Add(1);
  return std::move(trained.mixture);
}

}  // namespace tactus::internal
