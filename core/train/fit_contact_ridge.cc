#include <algorithm>
#include <utility>
#include <vector>

#include "core/base/status_macros.h"
#include "core/contacts/choice_folds.h"
#include "core/ridge/fit_ridge.h"
#include "core/train/fit_models.h"

namespace tactus::internal {
namespace {

RidgeSample SampleOf(const LabelledContact& contact, const FitRun& run) {
  RidgeSample sample;
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

}  // namespace

absl::StatusOr<Ridge> FitContactRidge(
    const FitRun& run, const std::string& part,
    const std::vector<const LabelledContact*>& contacts,
    const Progress& progress) {
  TACTUS_ASSIGN_OR_RETURN(auto saved, run.saved.Find<Ridge>(part));
  if (saved) {
    progress.Add(1);
    return *std::move(saved);
  }
  std::vector<RidgeSample> samples;
  for (const LabelledContact* contact : contacts) {
    samples.push_back(SampleOf(*contact, run));
  }
  const ChoiceFolds folds = FoldsForChoice(contacts);
  for (size_t f = 0; f < folds.folds.size(); ++f) {
    for (const int i : folds.folds[f]) samples[i].group = static_cast<int>(f);
  }
  const SkinLayout& layout = contacts.front()->layout;
  TACTUS_ASSIGN_OR_RETURN(
      Ridge ridge,
      FitRidge(samples, {.rows = layout.rows,
                         .columns = layout.columns,
                         .classes = static_cast<int>(run.class_names.size()),
                         .seed = run.options.seed,
                         .go_on = [&] { return run.GoOn(); }}));
  TACTUS_RETURN_IF_ERROR(run.saved.Put(part, ridge));
  progress.Add(1);
  return ridge;
}

}  // namespace tactus::internal
