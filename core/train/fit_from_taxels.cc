#include <algorithm>
#include <utility>
#include <vector>

#include "core/base/status_macros.h"
#include "core/contacts/choice_folds.h"
#include "core/nearest/fit_nearest.h"
#include "core/ridge/fit_ridge.h"
#include "core/train/fit_models.h"
#include "core/trees/fit_trees.h"

namespace tactus::internal {
namespace {

HistorySample SampleOf(const LabelledContact& contact, const FitRun& run) {
  HistorySample sample;
  for (size_t t = 0; t < contact.frames.size(); ++t) {
    if (contact.frames.touched(t)) {
      sample.frames.push_back(contact.frames.loads(t));
    }
  }
  sample.label =
      static_cast<int>(std::ranges::find(run.class_names, contact.label) -
                       run.class_names.begin());
  return sample;
}

std::vector<HistorySample> SamplesOf(
    const std::vector<const LabelledContact*>& contacts, const FitRun& run) {
  std::vector<HistorySample> samples;
  for (const LabelledContact* contact : contacts) {
    samples.push_back(SampleOf(*contact, run));
  }
  const ChoiceFolds folds = FoldsForChoice(contacts);
  for (size_t f = 0; f < folds.folds.size(); ++f) {
    for (const int i : folds.folds[f]) samples[i].group = static_cast<int>(f);
  }
  return samples;
}

// The part of the journal, or what `fit` makes of the contacts' samples.
template <class Learned, class Fit>
absl::StatusOr<Learned> FindOrFit(
    const FitRun& run, const std::string& part,
    const std::vector<const LabelledContact*>& contacts,
    const Progress& progress, const Fit& fit) {
  TACTUS_ASSIGN_OR_RETURN(auto learned, run.saved.Find<Learned>(part));
  if (!learned) {
    TACTUS_ASSIGN_OR_RETURN(learned, fit(SamplesOf(contacts, run)));
    TACTUS_RETURN_IF_ERROR(run.saved.Put(part, *learned));
  }
  progress.Add(1);
  return *std::move(learned);
}

}  // namespace

absl::StatusOr<Ridge> FitContactRidge(
    const FitRun& run, const std::string& part,
    const std::vector<const LabelledContact*>& contacts,
    const Progress& progress) {
  const SkinLayout& layout = contacts.front()->layout;
  return FindOrFit<Ridge>(
      run, part, contacts, progress,
      [&](const std::vector<HistorySample>& samples) {
        return FitRidge(samples,
                        {.shape = ShapeOf(layout),
                         .classes = static_cast<int>(run.class_names.size()),
                         .seed = run.options.seed,
                         .go_on = [&] { return run.GoOn(); }});
      });
}

absl::StatusOr<Trees> FitContactTrees(
    const FitRun& run, const std::string& part,
    const std::vector<const LabelledContact*>& contacts,
    const Progress& progress) {
  const SkinLayout& layout = contacts.front()->layout;
  return FindOrFit<Trees>(
      run, part, contacts, progress,
      [&](const std::vector<HistorySample>& samples) {
        return FitTrees(samples,
                        {.shape = ShapeOf(layout),
                         .classes = static_cast<int>(run.class_names.size()),
                         .seed = run.options.seed,
                         .go_on = [&] { return run.GoOn(); }});
      });
}

absl::StatusOr<Nearest> FitContactNearest(
    const FitRun& run, const std::string& part,
    const std::vector<const LabelledContact*>& contacts,
    const Progress& progress) {
  const SkinLayout& layout = contacts.front()->layout;
  return FindOrFit<Nearest>(
      run, part, contacts, progress,
      [&](const std::vector<HistorySample>& samples) {
        return FitNearest(samples,
                          {.shape = ShapeOf(layout),
                           .classes = static_cast<int>(run.class_names.size()),
                           .go_on = [&] { return run.GoOn(); }});
      });
}

}  // namespace tactus::internal
