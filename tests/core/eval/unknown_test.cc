#include "core/eval/unknown.h"

#include <map>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "gtest/gtest.h"
#include "tests/core/eval/synthetic_contacts.h"

namespace tactus::internal {
namespace {

TEST(AreaUnderRocTest, CountsPairsInOrderAndTiesByHalves) {
  const double positive[] = {3, 2};
  const double negative[] = {1, 2, 0};
  EXPECT_DOUBLE_EQ(AreaUnderRoc(positive, negative), 5.5 / 6);
  EXPECT_DOUBLE_EQ(AreaUnderRoc({}, negative), 0.5);
}

// Hanley and McNeil's example: 51 abnormal and 58 normal images, area 0.893,
// standard error 0.0325 by their formula.
TEST(AreaIntervalTest, IsHanleyAndMcNeils) {
  const Interval interval = AreaInterval(0.893, 51, 58);
  EXPECT_NEAR(interval.low, 0.893 - 1.96 * 0.0325, 1e-4);
  EXPECT_NEAR(interval.high, 0.893 + 1.96 * 0.0325, 1e-4);
  EXPECT_EQ(AreaInterval(1, 5, 5).high, 1);
  EXPECT_EQ(AreaInterval(0.5, 0, 5).low, 0);
}

// Three classes on three levels of force, at two conditions.
std::vector<LabelledContact> Levels() {
  std::vector<LabelledContact> contacts;
  Random random(1);
  const char* labels[] = {"a", "b", "c"};
  const double levels[] = {1, 2, 50};
  for (int c = 0; c < 3; ++c) {
    for (int i = 0; i < 20; ++i) {
      LabelledContact contact;
      contact.label = labels[c];
      contact.condition = i % 2 == 0 ? "slow" : "fast";
      for (int t = 0; t < 40; ++t) {
        contact.frames.push_back(
            {IdealSample({levels[c] * random.Uniform(0.9, 1.1), 1, 0.01})});
      }
      contacts.push_back(std::move(contact));
    }
  }
  return contacts;
}

TEST(EvaluateUnknownTest, FindsWhatIsFarFromAllThatWasFitted) {
  const std::vector<LabelledContact> contacts = Levels();
  std::vector<const LabelledContact*> pointers;
  for (const LabelledContact& contact : contacts) pointers.push_back(&contact);
  FitOptions options;
  options.states = 2;
  const auto results = EvaluateUnknown(pointers, options, RunSerially);
  ASSERT_TRUE(results.ok()) << results.status();
  ASSERT_EQ(results->size(), 3u);
  const UnknownResult& far = (*results)[2];
  EXPECT_EQ(far.left_out, "c");
  EXPECT_EQ(far.detected, 1);
  EXPECT_EQ(far.area_under_roc, 1);
  EXPECT_LT(far.false_alarms, 0.2);
}

// The HMMs see the area alone, which says nothing of the class, and the
// estimator the force. Networks that classify are only needed to have an
// estimator, so their number changes nothing.
TEST(EvaluateUnknownTest, FindsTheSoftestIfThereAreNetworks) {
  const std::map<std::string, double> stiffness = {
      {"HU", 1e6}, {"HM", 1e5}, {"SU", 1e3}, {"SM", 1e2}};
  std::vector<LabelledContact> contacts =
      testing::SyntheticContacts(120, 40, 0.02, 1);
  for (LabelledContact& contact : contacts) {
    contact.stiffness = stiffness.at(contact.label);
    contact.object_motion.assign(contact.frames.size(), 0.0);
  }
  FitOptions options;
  options.states = 2;
  options.hmm_cues = {Cue::kArea};
  options.lstm.cues = {NamedCue("log_force")};
  options.lstm.estimates = true;
  options.lstm.estimator_cells = {4};
  options.lstm.training.epochs = 20;
  const auto softest = [&](int networks) {
    options.lstm.networks = networks;
    const auto results =
        EvaluateUnknown(testing::PointersTo(contacts), options, RunSerially);
    EXPECT_TRUE(results.ok()) << results.status();
    EXPECT_EQ(results->back().left_out, "SM");
    return results->back().area_under_roc;
  };
  EXPECT_LT(softest(0), 0.6);
  EXPECT_GT(softest(1), 0.7);
  EXPECT_EQ(softest(3), softest(1));
}

TEST(EvaluateUnknownTest, RefusesTwoCategories) {
  const std::vector<LabelledContact> contacts = Levels();
  std::vector<const LabelledContact*> pointers;
  for (int i = 0; i < 40; ++i) pointers.push_back(&contacts[i]);
  EXPECT_FALSE(EvaluateUnknown(pointers, FitOptions(), RunSerially).ok());
}

}  // namespace
}  // namespace tactus::internal
