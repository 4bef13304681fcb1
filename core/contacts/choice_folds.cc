#include "core/contacts/choice_folds.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/contacts/class_counts.h"

namespace tactus::internal {
namespace {

using Contacts = std::vector<const LabelledContact*>;
using Folds = std::vector<std::vector<int>>;

constexpr size_t kMostLeftOutSingly = 8;
constexpr size_t kDealtFolds = 5;

double SumOfSquares(const ClassCounts& counts) {
  double sum = 0;
  for (const auto& [label, count] : counts) {
    sum += static_cast<double>(count) * count;
  }
  return sum;
}

// Deals whole groups to `count` folds, the largest first, each to the fold to
// whose classes it adds least: similar folds have small sums of squares.
Folds Deal(const Contacts& contacts, Folds groups, size_t count) {
  std::ranges::stable_sort(
      groups, [](const auto& a, const auto& b) { return a.size() > b.size(); });
  Folds folds(count);
  std::vector<ClassCounts> counts(count);
  for (const std::vector<int>& group : groups) {
    size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (size_t f = 0; f < count; ++f) {
      ClassCounts with = counts[f];
      for (const int i : group) ++with[contacts[i]->label];
      const double added = SumOfSquares(with) - SumOfSquares(counts[f]);
      if (added >= least) continue;
      least = added;
      best = f;
    }
    for (const int i : group) {
      folds[best].push_back(i);
      ++counts[best][contacts[i]->label];
    }
  }
  for (std::vector<int>& fold : folds) std::ranges::sort(fold);
  return folds;
}

// Empty if the protocol's groups cannot be left out.
Folds LeaveOut(const Contacts& contacts, Protocol protocol) {
  auto groups = MakeFolds(contacts, protocol);
  if (!groups.ok()) return {};
  Folds folds = groups->size() <= kMostLeftOutSingly
                    ? *std::move(groups)
                    : Deal(contacts, *std::move(groups), kDealtFolds);
  if (!LeavesEveryClass(contacts, folds)) return {};
  return folds;
}

}  // namespace

ChoiceFolds FoldsForChoice(const Contacts& contacts) {
  for (const auto& [by, protocol] :
       {std::pair{FoldsBy::kGroups, Protocol::kLeaveOneMaterialOut},
        std::pair{FoldsBy::kConditions, Protocol::kLeaveOneConditionOut}}) {
    Folds folds = LeaveOut(contacts, protocol);
    if (!folds.empty()) return {by, std::move(folds)};
  }
  return {FoldsBy::kClasses,
          StratifiedFolds(contacts, kStratifiedChoice.folds)};
}

}  // namespace tactus::internal
