#include "core/classify/step_clock.h"

#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

std::vector<uint64_t> Steps(const StepIntervals& intervals, uint64_t frames) {
  StepClock clock(intervals);
  std::vector<uint64_t> steps;
  for (uint64_t frame = 1; frame <= frames; ++frame) {
    if (clock.Tick(frame)) steps.push_back(frame);
  }
  return steps;
}

// Counted by hand.
TEST(StepClockTest, TheFirstStepIsAtMinUnlessStated) {
  EXPECT_THAT(Steps({5, 40}, 30),
              ::testing::ElementsAre(5, 10, 15, 20, 25, 30));
  EXPECT_THAT(Steps({.min = 5, .max = 50, .first = 1, .divisor = 8}, 60),
              ::testing::ElementsAre(1, 2, 3, 4, 6, 9, 13, 18, 23, 28, 33, 38,
                                     43, 48, 54, 60));
  EXPECT_THAT(Steps({.min = 4, .max = 40, .first = 3, .divisor = 2}, 20),
              ::testing::ElementsAre(3, 4, 6, 9, 13, 19));
  EXPECT_THAT(Steps({1, 1}, 4), ::testing::ElementsAre(1, 2, 3, 4));
}

TEST(StepClockTest, TheIntervalGrowsToMax) {
  const auto steps =
      Steps({.min = 5, .max = 50, .first = 1, .divisor = 8}, 3000);
  for (size_t i = 1; i < steps.size(); ++i) {
    const uint64_t interval = steps[i] - steps[i - 1];
    EXPECT_LE(interval, 50u);
    if (steps[i - 1] >= 400) {
      EXPECT_EQ(interval, 50u);
    }
  }
  EXPECT_EQ(steps.back() - steps[steps.size() - 2], 50u);
}

TEST(StepClockTest, AResetStartsOver) {
  StepClock clock({.min = 5, .max = 5, .first = 2});
  EXPECT_FALSE(clock.Tick(1));
  EXPECT_TRUE(clock.Tick(2));
  clock.Reset();
  EXPECT_FALSE(clock.Tick(1));
  EXPECT_TRUE(clock.Tick(2));
}

}  // namespace
}  // namespace tactus::internal
