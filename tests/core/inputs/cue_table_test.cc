#include "core/inputs/cue_table.h"

#include <vector>

#include "core/inputs/inputs.h"
#include "gtest/gtest.h"
#include "tests/core/eval/synthetic_contacts.h"

namespace tactus::internal {
namespace {

constexpr StepIntervals kSteps = {4, 8};

class CueTableTest : public ::testing::Test {
 protected:
  // So many that they fill several blocks, with copies too short for a step.
  CueTableTest()
      : contacts_(testing::SyntheticContacts(60, 40, 0.1, 1)),
        varied_(testing::PointersTo(contacts_),
                VariationRange{.copies = 4, .pace = 12, .load = 2}, 1) {}

  // The values at each step of each contact, as WalkCues finds them.
  std::vector<std::vector<double>> Expected() const {
    std::vector<std::vector<double>> contacts;
    LabelledContact made;
    for (size_t i = 0; i < varied_.size(); ++i) {
      std::vector<double>& values = contacts.emplace_back();
      WalkCues(varied_.Get(i, made), kSteps, kAllCueGroups, nullptr,
               [&](CueTracker& cues, size_t) {
                 for (const Cue cue : cues_) values.push_back(cues.value(cue));
               });
    }
    return contacts;
  }
  CueTable Table(size_t kept_bytes) const {
    return {varied_, cues_, {.steps = kSteps, .kept_bytes = kept_bytes}};
  }

  const std::vector<Cue> cues_ = StandardCues();
  std::vector<LabelledContact> contacts_;
  VariedContacts varied_;
};

TEST_F(CueTableTest, WalksInOrderWhateverTheThreadsDo) {
  std::vector<double> expected;
  for (const auto& values : Expected()) {
    expected.insert(expected.end(), values.begin(), values.end());
  }
  int most = 0;
  const ParallelFor backwards = [&](int count,
                                    const std::function<void(int)>& body) {
    most = std::max(most, count);
    for (int i = count - 1; i >= 0; --i) body(i);
  };
  CueTable table = Table(0);
  std::vector<double> walked;
  table.Walk(backwards, [&](std::span<const double> values) {
    walked.insert(walked.end(), values.begin(), values.end());
  });
  EXPECT_GT(most, 1) << "it takes several blocks to see their order";
  EXPECT_EQ(walked, expected);
  EXPECT_FALSE(table.kept());
}

TEST_F(CueTableTest, KeepsTheValuesOfEachContactIfTheyAreFew) {
  CueTable table = Table(size_t{1} << 30);
  EXPECT_FALSE(table.kept()) << "nothing was walked";
  table.Walk(RunSerially, [](std::span<const double>) {});
  ASSERT_TRUE(table.kept());
  const auto expected = Expected();
  int without_steps = 0;
  for (size_t i = 0; i < varied_.size(); ++i) {
    ASSERT_EQ(table.steps(i) * cues_.size(), expected[i].size()) << i;
    without_steps += table.steps(i) == 0 ? 1 : 0;
    std::vector<double> kept;
    for (size_t step = 0; step < table.steps(i); ++step) {
      const std::span<const double> values = table.values(i, step);
      kept.insert(kept.end(), values.begin(), values.end());
    }
    EXPECT_EQ(kept, expected[i]) << i;
  }
  EXPECT_GT(without_steps, 0);
}

}  // namespace
}  // namespace tactus::internal
