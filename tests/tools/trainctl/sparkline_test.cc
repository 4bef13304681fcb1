#include "tools/trainctl/sparkline.h"

#include <limits>
#include <vector>

#include "gtest/gtest.h"
#include "tools/trainctl/fit/learning_curves.h"

namespace tactus::internal::client {
namespace {

std::string Line(const std::vector<double>& values, size_t width) {
  return Sparkline(values, width);
}

TEST(SparklineTest, BlocksGrowWithTheValues) {
  EXPECT_EQ(Line({0, 1, 2, 3, 4, 5, 6, 7}, 20), "▁▂▃▄▅▆▇█");
  EXPECT_EQ(Line({8, 3, 2, 1}, 20), "█▃▂▁");
  EXPECT_EQ(Line({-1e300, 1e300}, 20), "▁█");
}

TEST(SparklineTest, LongCurvesBecomeMeans) {
  EXPECT_EQ(Line({0, 2, 4, 6, 10, 12}, 3), "▁▄█");
  EXPECT_EQ(Line(std::vector<double>(1000, 3), 5), "▁▁▁▁▁");
}

TEST(SparklineTest, WhatHasNoPlaceIsLeftOut) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_EQ(Line({nan, 0, infinite, 1, -infinite}, 20), "▁█");
  EXPECT_EQ(Line({nan}, 20), "");
  EXPECT_EQ(Line({}, 20), "");
  EXPECT_EQ(Line({1, 2}, 0), "");
}

TEST(LearningCurvesTest, ShowsTheCurveOfTheNewestPart) {
  LearningCurves curves;
  EXPECT_EQ(curves.Text(), "");
  for (const double loss : {3, 2, 1}) curves.Add("1", loss, false);
  EXPECT_EQ(curves.Text(), "█▅▁ 1");
  curves.Add("2", 5, false);
  EXPECT_EQ(curves.Text(), "▁ 5");
  curves.Add("1", 0.5, false);
  EXPECT_EQ(curves.Text(), "█▅▂▁ 0.5");
}

// The first value is that of a guess, far below all others.
TEST(LearningCurvesTest, LikelihoodsBeginWithTheFirstIteration) {
  LearningCurves curves;
  curves.Add("HU", -90000, true);
  EXPECT_EQ(curves.Text(), "▁ -9e+04");
  for (const double value : {-30, -20, -10}) curves.Add("HU", value, true);
  EXPECT_EQ(curves.Text(), "▁▅█ -10");
}

}  // namespace
}  // namespace tactus::internal::client
