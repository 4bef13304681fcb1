#include "core/contacts/choice_folds.h"

#include <map>
#include <set>
#include <string>

#include "gtest/gtest.h"
#include "tests/core/eval/synthetic_contacts.h"

namespace tactus::internal {
namespace {

using testing::PointersTo;

// `count` contacts of two classes; number i is of group `group(i)` and of
// condition `condition(i)`.
template <typename Group, typename Condition>
std::vector<LabelledContact> Make(int count, Group group, Condition condition) {
  std::vector<LabelledContact> contacts(count);
  for (int i = 0; i < count; ++i) {
    contacts[i].id = std::to_string(i);
    contacts[i].label = i % 2 == 0 ? "a" : "b";
    contacts[i].material = group(i);
    contacts[i].condition = condition(i);
  }
  return contacts;
}

std::string None(int) { return ""; }

auto Of(int number) {
  return [number](int i) { return std::to_string(i / 2 % number); };
}

// Every contact is in one fold, and no group is in two.
void ExpectPartition(const std::vector<LabelledContact>& contacts,
                     const ChoiceFolds& folds, bool by_group) {
  std::set<int> seen;
  std::map<std::string, std::set<size_t>> folds_of;
  for (size_t f = 0; f < folds.folds.size(); ++f) {
    for (const int i : folds.folds[f]) {
      EXPECT_TRUE(seen.insert(i).second);
      folds_of[by_group ? contacts[i].material : contacts[i].condition].insert(
          f);
    }
  }
  EXPECT_EQ(seen.size(), contacts.size());
  for (const auto& [name, in] : folds_of) EXPECT_EQ(in.size(), 1u) << name;
}

TEST(ChoiceFoldsTest, FewGroupsAreLeftOutOneByOne) {
  const auto contacts = Make(40, Of(4), Of(2));
  const ChoiceFolds folds = FoldsForChoice(PointersTo(contacts));
  EXPECT_EQ(folds.by, FoldsBy::kGroups);
  EXPECT_EQ(folds.folds.size(), 4u);
  ExpectPartition(contacts, folds, true);
}

TEST(ChoiceFoldsTest, ManyGroupsAreDealtWhole) {
  for (const int groups : {9, 20, 50}) {
    const auto contacts = Make(200, Of(groups), None);
    const ChoiceFolds folds = FoldsForChoice(PointersTo(contacts));
    EXPECT_EQ(folds.by, FoldsBy::kGroups);
    EXPECT_EQ(folds.folds.size(), 5u);
    ExpectPartition(contacts, folds, true);
    for (const auto& fold : folds.folds) {
      EXPECT_GT(fold.size(), 10u);
      EXPECT_LT(fold.size(), 80u);
    }
  }
}

// Groups of one class each can be left out together with those of the other.
TEST(ChoiceFoldsTest, GroupsOfOneClassAreDealtEvenly) {
  const auto contacts = Make(
      96,
      [](int i) {
        return std::to_string(i % 2) + "/" + std::to_string(i / 2 % 6);
      },
      None);
  const ChoiceFolds folds = FoldsForChoice(PointersTo(contacts));
  EXPECT_EQ(folds.by, FoldsBy::kGroups);
  ExpectPartition(contacts, folds, true);
  for (const auto& fold : folds.folds) {
    std::set<std::string> labels;
    for (const int i : fold) labels.insert(contacts[i].label);
    EXPECT_EQ(labels.size(), 2u);
  }
}

// A group per class: without it, the class is not there.
TEST(ChoiceFoldsTest, GroupsThatAreClassesAreNot) {
  const auto group = [](int i) { return i % 2 == 0 ? "x" : "y"; };
  const auto by_condition = Make(40, group, Of(4));
  const ChoiceFolds folds = FoldsForChoice(PointersTo(by_condition));
  EXPECT_EQ(folds.by, FoldsBy::kConditions);
  EXPECT_EQ(folds.folds.size(), 4u);
  ExpectPartition(by_condition, folds, false);
  const auto neither = Make(40, group, group);
  EXPECT_EQ(FoldsForChoice(PointersTo(neither)).by, FoldsBy::kClasses);
  EXPECT_EQ(FoldsForChoice(PointersTo(neither)).folds.size(), 3u);
}

// More than eight conditions were taken apart by stratified folds.
TEST(ChoiceFoldsTest, ManyConditionsStayWhole) {
  const auto contacts = Make(120, None, Of(12));
  const ChoiceFolds folds = FoldsForChoice(PointersTo(contacts));
  EXPECT_EQ(folds.by, FoldsBy::kConditions);
  ExpectPartition(contacts, folds, false);
}

}  // namespace
}  // namespace tactus::internal
