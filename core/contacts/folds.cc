#include "core/contacts/folds.h"

#include <algorithm>
#include <map>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/text.h"
#include "core/contacts/copies.h"

namespace tactus::internal {
namespace {

template <typename Key>
std::vector<std::vector<int>> GroupBy(
    const std::vector<const LabelledContact*>& contacts, Key key) {
  std::map<std::string, std::vector<int>> groups;
  for (size_t i = 0; i < contacts.size(); ++i) {
    groups[key(*contacts[i])].push_back(static_cast<int>(i));
  }
  std::vector<std::vector<int>> folds;
  for (auto& [name, members] : groups) folds.push_back(std::move(members));
  return folds;
}

absl::Status TooFewFolds(const std::vector<const LabelledContact*>& contacts,
                         Protocol protocol) {
  const bool conditions = protocol.kind == Protocol::kLeaveOneConditionOut;
  if (contacts.size() < 2 ||
      (!conditions && protocol.kind != Protocol::kLeaveOneMaterialOut)) {
    return InvalidTrainingData(
        absl::StrCat("the number of contacts to test with is ", contacts.size(),
                     "; it must be at least 2: record more"));
  }
  const std::string kind = conditions ? "condition" : "material";
  const LabelledContact& first = *contacts.front();
  return InvalidTrainingData(absl::StrCat(
      "the ", kind, " of all ", contacts.size(), " contacts is ",
      Quoted(conditions ? first.condition : first.material),
      "; to leave one out takes 2 or more: record others, or test with "
      "--protocol=k-fold"));
}

// Moves each contact to the fold of the first one with the same frames. Leaves
// out folds that become empty.
void KeepCopiesTogether(const std::vector<const LabelledContact*>& contacts,
                        std::vector<std::vector<int>>& folds) {
  const std::vector<int> first = FirstOfEqual(contacts);
  std::vector<size_t> fold_of(contacts.size());
  bool copies = false;
  for (size_t f = 0; f < folds.size(); ++f) {
    for (const int i : folds[f]) {
      fold_of[i] = f;
      copies |= first[i] != i;
    }
  }
  if (!copies) return;
  for (std::vector<int>& fold : folds) fold.clear();
  for (size_t i = 0; i < contacts.size(); ++i) {
    folds[fold_of[first[i]]].push_back(static_cast<int>(i));
  }
  std::erase_if(folds, [](const auto& fold) { return fold.empty(); });
}

}  // namespace

absl::StatusOr<Protocol> ParseProtocol(absl::string_view name, int folds) {
  if (folds < 2) return InvalidConfig("folds", folds, "at least 2");
  if (name == "loco") return Protocol::kLeaveOneConditionOut;
  if (name == "leave-one-out") return Protocol::kLeaveOneOut;
  if (name == "leave-one-material-out") return Protocol::kLeaveOneMaterialOut;
  if (name == "k-fold") return Protocol(Protocol::kKFold, folds);
  return InvalidConfig("protocol", name,
                       "loco, leave-one-out, leave-one-material-out or k-fold");
}

std::vector<std::vector<int>> StratifiedFolds(
    const std::vector<const LabelledContact*>& contacts, int count) {
  std::vector<std::vector<int>> folds(count);
  std::map<std::string, int> seen;
  const std::vector<int> first = FirstOfEqual(contacts);
  std::vector<int> fold_of(contacts.size());
  for (size_t i = 0; i < contacts.size(); ++i) {
    fold_of[i] = first[i] < static_cast<int>(i)
                     ? fold_of[first[i]]
                     : seen[contacts[i]->label]++ % count;
    folds[fold_of[i]].push_back(static_cast<int>(i));
  }
  std::erase_if(folds, [](const auto& fold) { return fold.empty(); });
  return folds;
}

absl::StatusOr<std::vector<std::vector<int>>> MakeFolds(
    const std::vector<const LabelledContact*>& contacts, Protocol protocol) {
  std::vector<std::vector<int>> folds;
  switch (protocol.kind) {
    case Protocol::kLeaveOneConditionOut:
      folds = GroupBy(contacts,
                      [](const LabelledContact& c) { return c.condition; });
      break;
    case Protocol::kLeaveOneMaterialOut:
      folds = GroupBy(contacts,
                      [](const LabelledContact& c) { return c.material; });
      break;
    case Protocol::kLeaveOneOut:
      for (size_t i = 0; i < contacts.size(); ++i) {
        folds.push_back({static_cast<int>(i)});
      }
      break;
    case Protocol::kKFold:
      folds = StratifiedFolds(contacts, protocol.folds);
      break;
  }
  KeepCopiesTogether(contacts, folds);
  if (folds.size() < 2) return TooFewFolds(contacts, protocol);
  return folds;
}

std::vector<int> Complement(const std::vector<int>& fold, int count) {
  std::vector<bool> in_fold(count, false);
  for (const int i : fold) in_fold[i] = true;
  std::vector<int> rest;
  rest.reserve(count - fold.size());
  for (int i = 0; i < count; ++i) {
    if (!in_fold[i]) rest.push_back(i);
  }
  return rest;
}

}  // namespace tactus::internal
