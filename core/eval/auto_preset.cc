#include "core/eval/auto_preset.h"

#include <algorithm>
#include <map>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/contacts/class_counts.h"
#include "core/contacts/folds.h"
#include "core/eval/baselines.h"
#include "core/eval/evaluate.h"

namespace tactus {
namespace {

constexpr size_t kMaxConditions = 8;

using Contacts = std::vector<const LabelledContact*>;

}  // namespace

absl::StatusOr<PresetChoice> ChoosePreset(
    const std::vector<const LabelledContact*>& contacts,
    const std::vector<std::pair<std::string, FitOptions>>& candidates,
    const ParallelFor& parallel, const Progress& progress) {
  TACTUS_RETURN_IF_ERROR(CheckClasses(CountClasses(contacts), "contacts"));
  PresetChoice choice;
  choice.contacts = static_cast<int>(contacts.size());
  Protocol protocol = kChoiceProtocol;
  auto folds = MakeFolds(contacts, Protocol::kLeaveOneConditionOut);
  if (folds.ok() && folds->size() <= kMaxConditions &&
      LeavesEveryClass(contacts, *folds)) {
    protocol = Protocol::kLeaveOneConditionOut;
    choice.by_condition = true;
  } else {
    folds = MakeFolds(contacts, protocol);
    TACTUS_RETURN_IF_ERROR(folds.status());
  }
  if (const absl::Status enough = CheckFolds(contacts, *folds, protocol);
      !enough.ok()) {
    return Advise(enough, "or name a preset, like --preset=profile");
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
        absl::StrCat("no preset suits the contacts: ", choice.unfit[0].first,
                     ": ", choice.unfit[0].second));
  }
  TACTUS_ASSIGN_OR_RETURN(const Baselines baselines,
                          MeasureBaselines(contacts, *folds));
  choice.nearest_right = baselines.nearest_right;
  choice.chance =
      static_cast<double>(baselines.frequent_right) / choice.contacts;
  return choice;
}

}  // namespace tactus
