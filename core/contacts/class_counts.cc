#include "core/contacts/class_counts.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/text.h"

namespace tactus::internal {
namespace {

using Contacts = std::vector<const LabelledContact*>;
using Folds = std::vector<std::vector<int>>;

constexpr char kSkip[] = "--skip-unusable";

// "1 contact", "2 contacts".
std::string Number(int count, absl::string_view noun) {
  return absl::StrCat(count, " ",
                      noun.substr(0, noun.size() - (count == 1 ? 1 : 0)));
}

// The least that any fold leaves of a class.
struct Least {
  int left = 0;
  size_t fold = 0;
};

std::map<std::string, Least> LeastLeft(const ClassCounts& all,
                                       const Contacts& contacts,
                                       const Folds& folds) {
  std::map<std::string, Least> least;
  for (const auto& [label, count] : all) least[label] = {count, 0};
  for (size_t f = 0; f < folds.size(); ++f) {
    ClassCounts tested;
    for (const int i : folds[f]) ++tested[contacts[i]->label];
    for (const auto& [label, count] : tested) {
      const int left = all.at(label) - count;
      if (left < least[label].left) least[label] = {left, f};
    }
  }
  return least;
}

// ", or leave it out with --skip-unusable" if two classes remain then.
std::string OrLeaveOut(size_t classes, size_t small) {
  if (classes < small + 2) return "";
  return absl::StrCat(", or leave ", small == 1 ? "it" : "such classes",
                      " out with ", kSkip);
}

// What a fold of the protocol leaves out.
std::string LeftOut(Protocol protocol, const LabelledContact& contact) {
  switch (protocol.kind) {
    case Protocol::kLeaveOneConditionOut:
      return absl::StrCat("condition ", Quoted(contact.condition));
    case Protocol::kLeaveOneMaterialOut:
      return absl::StrCat("material ", Quoted(contact.material));
    default:
      return "a fold";
  }
}

// Contacts of a class of which every fold leaves enough.
int EnoughForFolds(Protocol protocol) {
  return protocol.kind == Protocol::kKFold && protocol.folds == 2
             ? 2 * kMinContactsPerClass
             : kMinContactsPerClass + 1;
}

}  // namespace

ClassCounts CountClasses(const Contacts& contacts) {
  ClassCounts counts;
  for (const LabelledContact* contact : contacts) ++counts[contact->label];
  return counts;
}

std::vector<std::string> SmallClasses(const ClassCounts& counts) {
  std::vector<std::string> small;
  for (const auto& [label, count] : counts) {
    if (label.empty() || count < kMinContactsPerClass) small.push_back(label);
  }
  return small;
}

std::vector<std::string> SmallClasses(const Contacts& contacts,
                                      const Folds& folds) {
  std::vector<std::string> small;
  for (const auto& [label, least] :
       LeastLeft(CountClasses(contacts), contacts, folds)) {
    if (least.left < kMinContactsPerClass) small.push_back(label);
  }
  return small;
}

bool LeavesEveryClass(const Contacts& contacts, const Folds& folds) {
  return SmallClasses(contacts, folds).empty();
}

absl::Status CheckClasses(const ClassCounts& counts, absl::string_view noun) {
  int all = 0;
  for (const auto& [label, count] : counts) all += count;
  if (all == 0) {
    return InvalidTrainingData(absl::StrCat(
        "there are no ", noun,
        " to fit to; record some of 2 or more classes, and look at them with "
        "trainctl inspect"));
  }
  const auto unlabelled = counts.find("");
  if (unlabelled != counts.end()) {
    return InvalidTrainingData(absl::StrCat(
        unlabelled->second, " of ", Number(all, noun),
        " have no label; give each one, with the entry \"label\" of "
        "skin.json's fields or the column \"label\" of the table",
        OrLeaveOut(counts.size(), 1)));
  }
  if (counts.size() == 1) {
    return InvalidTrainingData(absl::StrCat(
        "the labels of all ", Number(all, noun), " are ",
        Quoted(counts.begin()->first), "; a model tells 2 to ",
        limits::kMaxClasses, " classes apart: record another class, too"));
  }
  if (counts.size() > limits::kMaxClasses) {
    return InvalidTrainingData(absl::StrCat(
        "the ", noun, " have ", counts.size(), " classes; it takes 2 to ",
        limits::kMaxClasses, ": give labels that trials have in common"));
  }
  const std::vector<std::string> small = SmallClasses(counts);
  if (small.empty()) return absl::OkStatus();
  std::vector<std::string> named;
  for (const std::string& label : small) {
    named.push_back(absl::StrCat("class ", Quoted(label), " has ",
                                 Number(counts.at(label), noun)));
  }
  return InvalidTrainingData(
      absl::StrCat(NameSome(named), "; a fit takes ", kMinContactsPerClass,
                   " or more of each class: record more of it",
                   OrLeaveOut(counts.size(), small.size())));
}

absl::Status CheckFolds(const Contacts& contacts, const Folds& folds,
                        Protocol protocol) {
  const ClassCounts all = CountClasses(contacts);
  const auto leasts = LeastLeft(all, contacts, folds);
  const std::vector<std::string> small = SmallClasses(contacts, folds);
  if (small.empty()) return absl::OkStatus();
  const std::string& label = small.front();
  const Least least = leasts.at(label);
  const int count = all.at(label);
  const int enough = EnoughForFolds(protocol);
  std::string advice;
  if (count < enough) {
    advice = absl::StrCat("record ", enough - count, " or more further ones");
    if (protocol.kind == Protocol::kLeaveOneConditionOut) {
      advice += " in other conditions";
    } else if (protocol.kind == Protocol::kLeaveOneMaterialOut) {
      advice += " of other materials";
    }
  } else if (protocol.kind == Protocol::kLeaveOneMaterialOut) {
    advice = "record it of another material, test with --protocol=k-fold";
  } else {
    advice = "record it in another condition, test with --protocol=k-fold";
  }
  std::string text = absl::StrCat(
      "class ", Quoted(label), " has ", Number(count, "contacts"),
      "; testing without ",
      LeftOut(protocol, *contacts[folds[least.fold].front()]), " leaves ",
      least.left, " to fit to, and it takes ", kMinContactsPerClass, ": ",
      advice, OrLeaveOut(all.size(), small.size()));
  if (small.size() > 1) {
    absl::StrAppend(&text, "; so it is with ",
                    NameSome({small.begin() + 1, small.end()}));
  }
  return InvalidTrainingData(text);
}

}  // namespace tactus::internal
