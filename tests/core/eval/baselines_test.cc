#include "core/eval/baselines.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "core/base/random.h"
#include "core/contacts/folds.h"
#include "gtest/gtest.h"
#include "tests/core/eval/synthetic_contacts.h"

namespace tactus::internal {
namespace {

using ::tactus::internal::testing::PointersTo;

// A contact whose largest area is `area`; it is touched before and after.
LabelledContact OfSize(const std::string& label, double area) {
  LabelledContact contact;
  contact.label = label;
  for (const double part : {0.5, 1., 0.2}) {
    contact.frames.push_back({IdealSample({1, part * area, 0})});
  }
  return contact;
}

// The most right answers that thresholds on the areas could give: every way to
// cut the sorted areas into at most as many parts as there are classes.
int BestByTrying(const std::vector<std::pair<double, std::string>>& sorted,
                 size_t from, int parts) {
  if (from == sorted.size()) return 0;
  if (parts == 0) return -1000;
  int best = -1000;
  std::map<std::string, int> counts;
  for (size_t end = from + 1; end <= sorted.size(); ++end) {
    ++counts[sorted[end - 1].second];
    if (end < sorted.size() && sorted[end].first == sorted[end - 1].first) {
      continue;
    }
    int most = 0;
    for (const auto& [label, count] : counts) most = std::max(most, count);
    best = std::max(best, most + BestByTrying(sorted, end, parts - 1));
  }
  return best;
}

TEST(BaselinesTest, SizesWithGapsAreToldApart) {
  std::vector<LabelledContact> contacts;
  for (int i = 0; i < 12; ++i) {
    // The largest class is neither the first nor the last label.
    const char* labels[] = {"medium", "small", "large"};
    const double areas[] = {2, 1, 3};
    contacts.push_back(OfSize(labels[i % 3], areas[i % 3] + 0.01 * (i / 3)));
  }
  const auto pointers = PointersTo(contacts);
  // In each fold, areas lie outside of those that were seen.
  const auto folds = StratifiedFolds(pointers, 2);
  EXPECT_EQ(CountSizeRight(pointers, folds), 12);
}

TEST(BaselinesTest, SizeAloneCannotTellEqualSizesApart) {
  std::vector<LabelledContact> contacts;
  for (int i = 0; i < 20; ++i) {
    contacts.push_back(OfSize(i % 4 == 0 ? "rare" : "frequent", 1));
  }
  const auto pointers = PointersTo(contacts);
  const auto baselines =
      MeasureBaselines(pointers, StratifiedFolds(pointers, 5));
  ASSERT_TRUE(baselines.ok()) << baselines.status();
  EXPECT_EQ(baselines->contacts, 20);
  EXPECT_EQ(baselines->frequent_right, 15);
  EXPECT_EQ(baselines->size_right, 15);
}

// Both folds hold the same contacts, so the count is what the thresholds were
// chosen for.
TEST(BaselinesTest, NoOtherThresholdsWouldDoBetter) {
  for (int seed = 0; seed < 20; ++seed) {
    Random random = Random::ForStream(7, seed);
    std::vector<LabelledContact> contacts;
    std::vector<std::pair<double, std::string>> sorted;
    for (int i = 0; i < 14; ++i) {
      const std::string label(1, static_cast<char>('a' + random.Index(3)));
      const double area = 1. + static_cast<double>(random.Index(9));
      contacts.push_back(OfSize(label, area));
      sorted.emplace_back(area, label);
    }
    std::ranges::sort(sorted);
    int classes = 0;
    for (const char* label : {"a", "b", "c"}) {
      classes += std::ranges::any_of(
          sorted, [&](const auto& s) { return s.second == label; });
    }
    const int before = static_cast<int>(contacts.size());
    for (int i = 0; i < before; ++i) contacts.push_back(contacts[i]);
    std::vector<std::vector<int>> folds(2);
    for (int i = 0; i < before; ++i) {
      folds[0].push_back(i);
      folds[1].push_back(i + before);
    }
    const int best = BestByTrying(sorted, 0, classes);
    EXPECT_EQ(CountSizeRight(PointersTo(contacts), folds), 2 * best)
        << "seed " << seed;
  }
}

TEST(BaselinesTest, ManyDifferentSizesStayQuickAndRight) {
  std::vector<LabelledContact> contacts;
  for (int i = 0; i < 2000; ++i) {
    contacts.push_back(OfSize(i < 1000 ? "small" : "large", 1 + 0.001 * i));
  }
  const auto pointers = PointersTo(contacts);
  const int right = CountSizeRight(pointers, StratifiedFolds(pointers, 4));
  // One of 256 ranks may hold both classes.
  EXPECT_GE(right, 2000 - 2000 / 256 - 1);
}

TEST(BaselinesTest, TheNearestContactAnswers) {
  const auto contacts = testing::SyntheticContacts(12, 40, 0.05, 3);
  const auto pointers = PointersTo(contacts);
  const auto folds = MakeFolds(pointers, {Protocol::kKFold, 4});
  ASSERT_TRUE(folds.ok()) << folds.status();
  const auto baselines = MeasureBaselines(pointers, *folds);
  ASSERT_TRUE(baselines.ok()) << baselines.status();
  EXPECT_EQ(baselines->frequent_right, 12);
  EXPECT_GE(baselines->nearest_right, 44);
  // Areas are drawn alike for all classes.
  EXPECT_LE(baselines->size_right, 24);
}

}  // namespace
}  // namespace tactus::internal
