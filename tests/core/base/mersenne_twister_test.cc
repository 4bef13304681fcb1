#include "core/base/mersenne_twister.h"

#include <random>
#include <vector>

#include "gtest/gtest.h"
#include "tests/support/for_each_target.h"

namespace tactus::internal {
namespace {

TEST(MersenneTwisterTest, DrawsWhatTheStandardsEngineDraws) {
  ForEachTarget([] {
    for (const uint64_t seed : {0ULL, 1ULL, 5489ULL, ~0ULL}) {
      MersenneTwister engine(seed);
      std::mt19937_64 standard(seed);
      for (int i = 0; i < 5'000; ++i) {
        ASSERT_EQ(engine(), standard())
            << "number " << i << " of seed " << seed;
      }
    }
  });
}

// Blocks of the engine hold 312 numbers.
TEST(MersenneTwisterTest, FillsWithTheNextNumbers) {
  ForEachTarget([] {
    MersenneTwister engine(7);
    std::mt19937_64 standard(7);
    for (const size_t count : {0, 1, 128, 183, 312, 313, 2'000}) {
      std::vector<uint64_t> numbers(count);
      engine.Fill(numbers);
      for (size_t i = 0; i < count; ++i) {
        ASSERT_EQ(numbers[i], standard()) << "number " << i << " of " << count;
      }
      ASSERT_EQ(engine(), standard()) << "after " << count;
    }
  });
}

TEST(MersenneTwisterTest, ACopyDrawsTheSameNumbers) {
  MersenneTwister engine(3);
  engine();
  MersenneTwister copy = engine;
  for (int i = 0; i < 1'000; ++i) ASSERT_EQ(engine(), copy());
}

}  // namespace
}  // namespace tactus::internal
