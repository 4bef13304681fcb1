#include "core/skin/idle_thresholds.h"

#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

TEST(IdleThresholdsTest, MarginsAreHalfOfTheSpreadOrTheLeast) {
  const IdleThresholds wide = ThresholdsAbove(2, 10, 1);
  EXPECT_EQ(wide.margin, 4);
  EXPECT_EQ(wide.contact_threshold, 14);
  EXPECT_EQ(wide.onset_threshold, 18);
  const IdleThresholds narrow = ThresholdsAbove(2, 3, 1);
  EXPECT_EQ(narrow.margin, 1);
  EXPECT_EQ(narrow.contact_threshold, 4);
  EXPECT_EQ(narrow.onset_threshold, 5);
}

TEST(IdleThresholdsTest, QuantilesAreMeasuredValues) {
  std::vector<float> values;
  for (int i = 999; i >= 0; --i) values.push_back(static_cast<float>(i));
  EXPECT_EQ(IdleQuantile(values, 0.5), 500);
  EXPECT_EQ(IdleQuantile(values, kIdleFraction), 999);
  EXPECT_EQ(IdleQuantile(std::vector<float>{7}, kIdleFraction), 7);
}

}  // namespace
}  // namespace tactus::internal
