#include "core/contacts/folds.h"

#include <map>
#include <set>

#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "tests/core/eval/synthetic_contacts.h"

namespace tactus::internal {
namespace {

TEST(MakeFoldsTest, EveryContactIsTestedOnceAndNeverWithItsGroup) {
  const auto contacts = testing::SyntheticContacts(12, 5, 0.1, 1);
  const auto pointers = testing::PointersTo(contacts);
  struct Case {
    const char* name;
    size_t folds;
  };
  for (const Case c : {Case{"loco", 2}, Case{"leave-one-out", 48},
                       Case{"leave-one-material-out", 3}, Case{"k-fold", 10}}) {
    auto folds = MakeFolds(pointers, *ParseProtocol(c.name));
    ASSERT_TRUE(folds.ok()) << c.name;
    EXPECT_EQ(folds->size(), c.folds) << c.name;
    std::multiset<int> tested;
    for (const auto& fold : *folds) {
      tested.insert(fold.begin(), fold.end());
      const auto rest = Complement(fold, 48);
      EXPECT_EQ(rest.size() + fold.size(), 48u);
      for (int i : rest) {
        for (int j : fold) {
          ASSERT_NE(i, j);
          if (std::string(c.name) == "loco") {
            ASSERT_NE(contacts[i].condition, contacts[j].condition);
          }
          if (std::string(c.name) == "leave-one-material-out") {
            ASSERT_NE(contacts[i].material, contacts[j].material);
          }
        }
      }
    }
    EXPECT_EQ(tested.size(), 48u) << c.name;
    EXPECT_EQ(std::set<int>(tested.begin(), tested.end()).size(), 48u);
  }
}

TEST(MakeFoldsTest, KFoldMakesAsManyAsAskedForOfEvenClasses) {
  auto contacts = testing::SyntheticContacts(12, 5, 0.1, 1);
  auto protocol = ParseProtocol("k-fold", 5);
  ASSERT_TRUE(protocol.ok());
  auto folds = MakeFolds(testing::PointersTo(contacts), *protocol);
  ASSERT_TRUE(folds.ok());
  ASSERT_EQ(folds->size(), 5u);
  for (const auto& fold : *folds) {
    std::map<std::string, int> labels;
    for (int i : fold) ++labels[contacts[i].label];
    ASSERT_EQ(labels.size(), 4u);
    // 12 contacts of each class.
    for (const auto& [label, count] : labels) {
      EXPECT_GE(count, 2) << label;
      EXPECT_LE(count, 3) << label;
    }
  }
  EXPECT_EQ(ReasonOf(ParseProtocol("k-fold", 1).status()), "INVALID_CONFIG");
}

TEST(MakeFoldsTest, OneGroupIsNoProtocol) {
  auto contacts = testing::SyntheticContacts(2, 5, 0.1, 1);
  for (auto& contact : contacts) contact.condition = "same";
  EXPECT_EQ(ReasonOf(MakeFolds(testing::PointersTo(contacts),
                               Protocol::kLeaveOneConditionOut)
                         .status()),
            "INVALID_TRAINING_DATA");
  EXPECT_EQ(ReasonOf(ParseProtocol("loocv").status()), "INVALID_CONFIG");
}

}  // namespace
}  // namespace tactus::internal
