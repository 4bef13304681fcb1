#include "core/eval/auto_preset.h"

#include <algorithm>
#include <map>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/contacts/folds.h"
#include "core/eval/baselines.h"
#include "core/eval/evaluate.h"

namespace tactus {
namespace {

constexpr int kFolds = 3;
constexpr size_t kMaxConditions = 8;

using Contacts = std::vector<const LabelledContact*>;

// True if every class has two contacts outside of each fold, as a fit needs.
bool LeavesEveryClass(const Contacts& contacts,
                      const std::vector<std::vector<int>>& folds) {
  std::map<std::string, int> all;
  for (const LabelledContact* contact : contacts) ++all[contact->label];
  for (const std::vector<int>& fold : folds) {
    std::map<std::string, int> rest = all;
    for (const int i : fold) {
      if (--rest[contacts[i]->label] < 2) return false;
    }
  }
  return true;
}

}  // namespace

absl::StatusOr<PresetChoice> ChoosePreset(
    const std::vector<const LabelledContact*>& contacts,
    const std::vector<std::pair<std::string, FitOptions>>& candidates,
    const ParallelFor& parallel, const Progress& progress) {
  if (contacts.empty()) {
    return InvalidTrainingData("there is no contact to choose a preset for");
  }
  PresetChoice choice;
  choice.contacts = static_cast<int>(contacts.size());
  Protocol protocol(Protocol::kKFold, kFolds);
  auto folds = MakeFolds(contacts, Protocol::kLeaveOneConditionOut);
  if (folds.ok() && folds->size() <= kMaxConditions &&
      LeavesEveryClass(contacts, *folds)) {
    protocol = Protocol::kLeaveOneConditionOut;
    choice.by_condition = true;
  } else {
    folds = MakeFolds(contacts, protocol);
    TACTUS_RETURN_IF_ERROR(folds.status());
  }
  if (!LeavesEveryClass(contacts, *folds)) {
    return InvalidTrainingData(absl::StrCat(
        "a class has too few contacts to choose a preset by cross-validation "
        "in ",
        kFolds, " folds; record three or more of each, or name a preset"));
  }
  choice.folds = static_cast<int>(folds->size());
  const Progress each = progress.Part("choose preset", 1);
  int most = -1;
  for (const auto& [name, candidate] : candidates) {
    FitOptions options = candidate;
    options.calibrate = false;
    const auto result =
        EvaluateProtocol(contacts, protocol, Algorithm::kHmm, options, parallel,
                         each.Part("", 1.0 / candidates.size()));
    if (!result.ok()) {
      choice.unfit.emplace_back(name, result.status().message());
      continue;
    }
    const int right = CountRight(result->final);
    choice.right.emplace_back(name, right);
    if (right <= most) continue;
    most = right;
    choice.name = name;
    choice.options = candidate;
  }
  if (choice.right.empty()) {
    return InvalidTrainingData(
        "no preset suits the contacts; name one to learn why");
  }
  TACTUS_ASSIGN_OR_RETURN(const Baselines baselines,
                          MeasureBaselines(contacts, *folds));
  choice.nearest_right = baselines.nearest_right;
  choice.chance =
      static_cast<double>(baselines.frequent_right) / choice.contacts;
  return choice;
}

}  // namespace tactus
