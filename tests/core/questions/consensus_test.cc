#include "core/questions/consensus.h"

#include <array>
#include <cmath>

#include "core/base/random.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

using Pair = std::array<double, 2>;

Pair Agreed(const Pair& before, Pair now) {
  Consensus(before, now);
  return now;
}

TEST(ConsensusTest, TheLessSureOfTwoThatAgree) {
  EXPECT_EQ(Agreed({0.9, 0.1}, {0.97, 0.03}), (Pair{0.9, 0.1}));
  EXPECT_EQ(Agreed({0.97, 0.03}, {0.9, 0.1}), (Pair{0.9, 0.1}));
  EXPECT_EQ(Agreed({0.3, 0.7}, {0.3, 0.7}), (Pair{0.3, 0.7}));
}

// Half the log-odds: ln(0.96 / 0.04) / 2 = 1.589, and 1 / (1 + e^-1.589).
TEST(ConsensusTest, AChangeCountsHalfUntilItIsSeenAgain) {
  const Pair first = Agreed({0.99, 0.01}, {0.04, 0.96});
  EXPECT_NEAR(first[1], 0.830479, 1e-6);
  EXPECT_EQ(Agreed({0.04, 0.96}, {0.03, 0.97}), (Pair{0.04, 0.96}));
}

TEST(ConsensusTest, TheFirstEvaluationCountsHalf) {
  Pair now = {0.96, 0.04};
  Consensus({}, now);
  EXPECT_NEAR(now[0], 0.830479, 1e-6);
}

TEST(ConsensusTest, CertaintyStaysADistribution) {
  EXPECT_EQ(Agreed({1, 0}, {0, 1}), (Pair{0, 1}));
  EXPECT_EQ(Agreed({1, 0}, {1, 0}), (Pair{1, 0}));
}

// Whatever is evaluated: it sums to 1, keeps the most probable value of the
// later evaluation, and is no more sure than that.
TEST(ConsensusTest, OfManyValuesTheLaterOneIsKept) {
  Random random(5);
  for (int n = 0; n < 1000; ++n) {
    std::array<std::array<double, 4>, 2> both;
    for (auto& each : both) {
      double sum = 0;
      for (double& p : each) sum += p = std::exp(random.Uniform(-9, 0));
      for (double& p : each) p /= sum;
    }
    auto agreed = both[1];
    Consensus(both[0], agreed);
    EXPECT_NEAR(agreed[0] + agreed[1] + agreed[2] + agreed[3], 1, 1e-12);
    const auto best = std::ranges::max_element(both[1]) - both[1].begin();
    EXPECT_EQ(std::ranges::max_element(agreed) - agreed.begin(), best);
    EXPECT_LE(agreed[best], both[1][best]);
  }
}

}  // namespace
}  // namespace tactus::internal
