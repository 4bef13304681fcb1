#include "server/trainer/compare.h"

#include <algorithm>
#include <cmath>

#include "core/contacts/anytime.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal::server {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

// 2 * sum over k <= min(a, b) of C(n, k) / 2^n with n = a + b, at most 1
// (McNemar, Psychometrika 12, 1947, in its exact form), in exact fractions
// (Python's fractions and math.comb).
TEST(CompareTest, McNemarIsExact) {
  struct Case {
    uint32_t first, second;
    double p;
  };
  const Case cases[] = {{0, 0, 1},
                        {0, 1, 1},
                        {1, 1, 1},
                        {6, 6, 1},
                        {0, 5, 0.0625},
                        {1, 9, 0.021484375},
                        {3, 12, 0.03515625},
                        {10, 25, 0.0166738478001207},
                        {121, 59, 4.43444926375518e-06},
                        {0, 60, 1.73472347597681e-18},
                        {500, 450, 0.111838645141579}};
  for (const Case& c : cases) {
    EXPECT_NEAR(McNemar(c.first, c.second), c.p, 1e-10 * c.p);
    EXPECT_EQ(McNemar(c.first, c.second), McNemar(c.second, c.first));
  }
}

// Two classes. The first `both` contacts are right in both, the next
// `only_current` and `only_candidate` in one.
std::pair<Evaluation, Evaluation> Evaluations(int both, int only_current,
                                              int only_candidate) {
  Evaluation current, candidate;
  current.class_names = {"a", "b"};
  candidate.class_names = {"a", "b"};
  for (int i = 0; i < both + only_current + only_candidate; ++i) {
    const bool old_right = i < both + only_current;
    const bool new_right = i < both || i >= both + only_current;
    const auto outcome = [&](bool right) {
      return Outcome{.label = 0,
                     .probability = {right ? 0.8 : 0.3, right ? 0.2 : 0.7}};
    };
    current.final.push_back(outcome(old_right));
    candidate.final.push_back(outcome(new_right));
  }
  current.anytime.assign(kAnytimeCount, current.final);
  candidate.anytime.assign(kAnytimeCount, candidate.final);
  return {current, candidate};
}

// Clopper and Pearson, Biometrika 26, 1934: the p at which P(X >= x) or
// P(X <= x) is 0.025, by bisection with 60 digits (Python's decimal). With 0 of
// 10 the high end is 1 - 0.025^(1/10).
TEST(CompareTest, TheIntervalIsExact) {
  struct Case {
    int only_current, only_candidate;
    double low, high;
  };
  const Case cases[] = {{0, 1, 0.025, 1},
                        {1, 1, 0.0125791170934, 0.987420882907},
                        {10, 0, 0, 0.308497107819},
                        {0, 10, 0.691502892181, 1},
                        {15, 5, 0.0865714691014, 0.491045871708},
                        {3, 97, 0.914823947026, 0.993770028462},
                        {85, 15, 0.0864543856416, 0.235307500149},
                        {1, 999, 0.99444107572, 0.999974682513}};
  EXPECT_NEAR(1 - std::pow(0.025, 0.1), 0.308497107819, 1e-12);
  for (const Case& c : cases) {
    const auto [current, candidate] =
        Evaluations(5, c.only_current, c.only_candidate);
    const v1::Comparison comparison = Compare(current, candidate, 3, {});
    EXPECT_EQ(comparison.only_current(), static_cast<uint32_t>(c.only_current));
    EXPECT_EQ(comparison.only_candidate(),
              static_cast<uint32_t>(c.only_candidate));
    EXPECT_NEAR(comparison.win_low(), c.low, 1e-9);
    EXPECT_NEAR(comparison.win_high(), c.high, 1e-9);
    EXPECT_EQ(comparison.current().never_felt(), 3u);
  }
}

TEST(CompareTest, TheGateAllowsItsMargins) {
  // 90 of 100 against 85.
  const auto [current, candidate] = Evaluations(80, 10, 5);
  v1::JobGate gate;
  gate.set_log_loss_margin(10);
  gate.set_calibration_margin(1);
  gate.set_accuracy_margin(0.06);
  EXPECT_TRUE(Compare(current, candidate, 0, gate).passed());
  gate.set_accuracy_margin(0.05);
  const v1::Comparison refused = Compare(current, candidate, 0, gate);
  EXPECT_FALSE(refused.passed());
  EXPECT_THAT(refused.failure(), HasSubstr("error rate"));
  EXPECT_TRUE(Compare(candidate, current, 0, gate).passed());
  gate.set_accuracy_margin(1);
  gate.set_log_loss_margin(0);
  EXPECT_THAT(Compare(current, candidate, 0, gate).failure(),
              HasSubstr("log-loss"));
  EXPECT_TRUE(Compare(current, current, 0, {}).passed());
}

TEST(CompareTest, ReportsFigures) {
  const auto [current, candidate] = Evaluations(3, 1, 0);
  const v1::EvaluationReport report = ReportOf(candidate, 2);
  EXPECT_EQ(report.accuracy().correct(), 3u);
  EXPECT_EQ(report.accuracy().contacts(), 4u);
  EXPECT_NEAR(report.log_loss(), -(3 * std::log(0.8) + std::log(0.3)) / 4,
              1e-12);
  EXPECT_EQ(report.confusion_size(), 4);
  EXPECT_EQ(report.confusion(0), 3u);
  EXPECT_EQ(report.confusion(1), 1u);
  EXPECT_EQ(report.anytime_size(), kAnytimeCount);
  EXPECT_THAT(report.questions(), IsEmpty());
}

// Tops of 0.8 (right) and 0.7 (wrong) are in the bins 12 and 10 of 15.
TEST(CompareTest, ReportsReliability) {
  const auto [current, candidate] = Evaluations(3, 1, 0);
  const v1::EvaluationReport report = ReportOf(candidate, 0);
  ASSERT_EQ(report.reliability_size(), 2);
  const v1::ReliabilityBin& wrong = report.reliability(0);
  EXPECT_DOUBLE_EQ(wrong.low(), 10. / 15);
  EXPECT_DOUBLE_EQ(wrong.high(), 11. / 15);
  EXPECT_DOUBLE_EQ(wrong.confidence(), 0.7);
  EXPECT_EQ(wrong.accuracy().correct(), 0u);
  EXPECT_EQ(wrong.accuracy().contacts(), 1u);
  const v1::ReliabilityBin& right = report.reliability(1);
  EXPECT_DOUBLE_EQ(right.low(), 12. / 15);
  EXPECT_NEAR(right.confidence(), 0.8, 1e-15);
  EXPECT_EQ(right.accuracy().correct(), 3u);
  // Wilson's interval of 3 of 3: (3 / (3 + z^2), 1) with z = 1.959964.
  EXPECT_NEAR(right.accuracy().low(), 3 / (3 + 1.959964 * 1.959964), 1e-6);
}

TEST(CompareTest, ReportsEachQuestion) {
  Evaluation evaluation = Evaluations(4, 0, 0).first;
  evaluation.questions = {
      {"hardness", Question::kProperty, {"hard", "soft"}, {0, 1}},
      {"mobility", Question::kState, {"no", "yes"}, {0, 1}}};
  // Hardness: contact i is right from the i-th time on. Mobility: one of four
  // is right, and only in the end.
  evaluation.question_outcomes.assign(2, std::vector<QuestionOutcome>(4));
  const auto outcome = [](bool right) {
    return Outcome{.label = 1, .probability = {right ? 0.1 : 0.9, 0.5}};
  };
  for (int i = 0; i < 4; ++i) {
    for (int t = 0; t < kAnytimeCount; ++t) {
      evaluation.question_outcomes[0][i].anytime.push_back(outcome(t >= i));
      evaluation.question_outcomes[1][i].anytime.push_back(outcome(false));
    }
    evaluation.question_outcomes[0][i].final = outcome(true);
    evaluation.question_outcomes[1][i].final = outcome(i == 2);
  }
  const v1::EvaluationReport report = ReportOf(evaluation, 0);
  ASSERT_EQ(report.questions_size(), 2);
  const v1::QuestionReport& hardness = report.questions(0);
  EXPECT_EQ(hardness.name(), "hardness");
  EXPECT_EQ(hardness.accuracy().correct(), 4u);
  EXPECT_EQ(hardness.accuracy().contacts(), 4u);
  ASSERT_EQ(hardness.anytime_size(), kAnytimeCount);
  for (int t = 0; t < kAnytimeCount; ++t) {
    EXPECT_EQ(hardness.anytime(t).correct(), std::min(t + 1u, 4u));
  }
  const v1::QuestionReport& mobility = report.questions(1);
  EXPECT_EQ(mobility.name(), "mobility");
  EXPECT_EQ(mobility.accuracy().correct(), 1u);
  EXPECT_EQ(mobility.anytime(kAnytimeCount - 1).correct(), 0u);
  EXPECT_NEAR(mobility.accuracy().low(), 0.0455873, 1e-6);
  EXPECT_NEAR(mobility.accuracy().high(), 0.6993582, 1e-6);
}

}  // namespace
}  // namespace tactus::internal::server
