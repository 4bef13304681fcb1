#include "core/eval/reliability.h"

#include <cmath>

#include "core/base/random.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

using ::testing::DoubleNear;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// Two classes, the first answered with probability `top`.
Outcome Answered(double top, bool right) {
  return {right ? 0 : 1, {top, 1 - top}};
}

TEST(ReliabilityBinsTest, WithoutOutcomesThereIsNone) {
  EXPECT_THAT(ReliabilityBins({}), IsEmpty());
}

TEST(ReliabilityBinsTest, BinsHoldMeansOfTheirOutcomes) {
  const std::vector<Outcome> outcomes = {
      Answered(0.95, true), Answered(0.97, true), Answered(0.99, false),
      Answered(0.62, false), Answered(1.0, true)};
  const auto bins = ReliabilityBins(outcomes);
  ASSERT_THAT(bins, SizeIs(2));
  EXPECT_EQ(bins[0].count, 1);
  EXPECT_DOUBLE_EQ(bins[0].mean_probability, 0.62);
  EXPECT_EQ(bins[0].right, 0);
  EXPECT_DOUBLE_EQ(bins[0].low, 9. / 15);
  EXPECT_DOUBLE_EQ(bins[0].high, 10. / 15);
  EXPECT_EQ(bins[1].count, 4);
  EXPECT_DOUBLE_EQ(bins[1].mean_probability, (0.95 + 0.97 + 0.99 + 1) / 4);
  EXPECT_EQ(bins[1].right, 3);
}

TEST(ReliabilityBinsTest, TheyAreTheBinsOfTheCalibrationError) {
  Random random(5);
  std::vector<Outcome> outcomes;
  for (int i = 0; i < 400; ++i) {
    const double top = random.Uniform(0.5, 1);
    outcomes.push_back(Answered(top, random.Uniform() < 0.8));
  }
  double error = 0;
  for (const ReliabilityBin& bin : ReliabilityBins(outcomes)) {
    error += std::abs(bin.right - bin.count * bin.mean_probability) / 400;
  }
  EXPECT_THAT(error, DoubleNear(ExpectedCalibrationError(outcomes), 1e-12));
}

}  // namespace
}  // namespace tactus::internal
