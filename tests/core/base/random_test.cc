#include "core/base/random.h"

#include <random>
#include <set>

#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

// The standard fixes mt19937_64: its 10,000th number from the default seed is
// 9981545732273789042. Uniform() keeps the upper 53 bits.
TEST(RandomTest, IsTheStandardsEngine) {
  Random random(std::mt19937_64::default_seed);
  double value = 0;
  for (int i = 0; i < 10'000; ++i) value = random.Uniform();
  EXPECT_EQ(value,
            static_cast<double>(9981545732273789042ULL >> 11) * 0x1.0p-53);
}

TEST(RandomTest, GaussianHasItsMoments) {
  Random random(1);
  constexpr int kCount = 200'000;
  double sum = 0;
  double squares = 0;
  double fourth = 0;
  for (int i = 0; i < kCount; ++i) {
    const double x = random.Gaussian();
    sum += x;
    squares += x * x;
    fourth += x * x * x * x;
  }
  EXPECT_NEAR(sum / kCount, 0, 0.01);
  EXPECT_NEAR(squares / kCount, 1, 0.02);
  EXPECT_NEAR(fourth / kCount, 3, 0.15);
}

TEST(RandomTest, IndexStaysInRangeAndReachesAll) {
  Random random(2);
  std::set<uint64_t> seen;
  for (int i = 0; i < 1'000; ++i) seen.insert(random.Index(7));
  EXPECT_EQ(seen.size(), 7u);
  EXPECT_EQ(*seen.rbegin(), 6u);
}

TEST(RandomTest, StreamsDifferAndRepeat) {
  EXPECT_EQ(Random::ForStream(1, 2).Uniform(),
            Random::ForStream(1, 2).Uniform());
  EXPECT_NE(Random::ForStream(1, 2).Uniform(),
            Random::ForStream(1, 3).Uniform());
  EXPECT_NE(Random::ForStream(1, 2).Uniform(),
            Random::ForStream(2, 2).Uniform());
}

}  // namespace
}  // namespace tactus::internal
