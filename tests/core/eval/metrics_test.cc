#include "core/eval/metrics.h"

#include <cmath>

#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

TEST(MetricsTest, ConfusionAndAccuracyCount) {
  const Outcome outcomes[] = {
      {0, {0.9, 0.1}}, {0, {0.2, 0.8}}, {1, {0.1, 0.9}}, {1, {0.4, 0.6}}};
  EXPECT_EQ(CountConfusion(outcomes, 2), (Confusion{{1, 1}, {0, 2}}));
  EXPECT_DOUBLE_EQ(Accuracy(outcomes), 0.75);
  EXPECT_DOUBLE_EQ(Accuracy({}), 0);
}

// Published examples: Newcombe, Statistics in Medicine 17 (1998), table I,
// method 3.
TEST(MetricsTest, WilsonIntervalsAreThoseOfNewcombe) {
  const struct {
    int successes, count;
    double low, high;
  } examples[] = {{81, 263, 0.2553, 0.3662},
                  {15, 148, 0.0624, 0.1605},
                  {0, 20, 0.0000, 0.1611},
                  {1, 29, 0.0061, 0.1718}};
  for (const auto& example : examples) {
    const Interval interval = WilsonInterval(example.successes, example.count);
    EXPECT_NEAR(interval.low, example.low, 5e-5) << example.successes;
    EXPECT_NEAR(interval.high, example.high, 5e-5) << example.successes;
  }
  EXPECT_EQ(WilsonInterval(0, 0).low, 0);
  EXPECT_EQ(WilsonInterval(0, 0).high, 1);
  EXPECT_EQ(WilsonInterval(20, 20).high, 1);
}

// Worked by hand: bin of 0.9 holds 2 (1 right), bin of 0.6 holds 2 (2 right).
TEST(MetricsTest, CalibrationErrorIsTheWeightedGap) {
  const Outcome outcomes[] = {
      {0, {0.9, 0.1}}, {1, {0.9, 0.1}}, {0, {0.6, 0.4}}, {0, {0.6, 0.4}}};
  EXPECT_NEAR(ExpectedCalibrationError(outcomes),
              0.5 * std::abs(0.5 - 0.9) + 0.5 * std::abs(1.0 - 0.6), 1e-12);
  const Outcome certain[] = {{1, {0, 1}}};
  EXPECT_DOUBLE_EQ(ExpectedCalibrationError(certain), 0);
}

TEST(MetricsTest, ErrorsOfEstimatesAreSummedUp) {
  // By hand: sizes 1, 2, 2, 5; squares 34; the first and the last covered.
  const EstimateError errors[] = {{-1, 1}, {2, 1.9}, {-2, 0.1}, {5, 6}};
  const EstimateErrors summary = SummariseErrors(errors);
  EXPECT_EQ(summary.count, 4);
  EXPECT_DOUBLE_EQ(summary.median, 2);
  EXPECT_DOUBLE_EQ(summary.root_mean_square, std::sqrt(34.0 / 4));
  EXPECT_DOUBLE_EQ(summary.covered, 0.5);
  EXPECT_EQ(SummariseErrors({}).count, 0);
}

TEST(MetricsTest, OnlyKnownContactsWithALargeProbabilityGetASureAnswer) {
  const std::vector<Outcome> outcomes = {{0, {0.97, 0.03}},
                                         {1, {0.96, 0.04}},
                                         {0, {0.94, 0.06}},
                                         {1, {0.02, 0.98}},
                                         {1, {0.02, 0.98}}};
  const std::vector<double> unknown = {0.1, 0.1, 0.1, 0.49, 0.5};
  const SureAnswers sure = CountSure(outcomes, unknown, 0.95);
  EXPECT_EQ(sure.count, 3);
  EXPECT_EQ(sure.right, 2);
  EXPECT_EQ(CountSure({}, {}, 0.95).count, 0);
  EXPECT_EQ(TopProbabilities(outcomes, true),
            (std::vector<double>{0.97, 0.94, 0.98, 0.98}));
  EXPECT_EQ(TopProbabilities(outcomes, false), std::vector<double>{0.96});
}

}  // namespace
}  // namespace tactus::internal
