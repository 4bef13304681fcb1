#include "client/drivers/calibration/gain_curve.h"

#include <cmath>
#include <limits>

#include "core/base/errors.h"
#include "gtest/gtest.h"

namespace tactus::internal::client {
namespace {

TEST(GainCurveTest, IsLinearBetweenItsPointsAndBeyond) {
  const auto curve = GainCurve::Make({{40, 0.5}, {120, 2.5}, {220, 3}});
  ASSERT_TRUE(curve.ok()) << curve.status();
  const GainPoint expected[] = {{0, 0},    {20, 0.25}, {40, 0.5},
                                {80, 1.5}, {120, 2.5}, {170, 2.75},
                                {220, 3},  {420, 4},   {-20, -0.25}};
  for (const GainPoint& point : expected) {
    EXPECT_DOUBLE_EQ(curve->Load(point.reading), point.load) << point.reading;
  }
}

TEST(GainCurveTest, AReadingStandsForOneLoad) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const std::vector<std::vector<GainPoint>> bad = {{},
                                                   {{0, 1}},
                                                   {{1, 0}},
                                                   {{-1, -1}},
                                                   {{1, 1}, {1, 2}},
                                                   {{1, 1}, {2, 1}},
                                                   {{1, 1}, {3, 3}, {2, 4}},
                                                   {{1, 1}, {2, 3}, {3, 2}},
                                                   {{nan, 1}},
                                                   {{1, nan}},
                                                   {{1, 1}, {inf, 2}},
                                                   {{1, 1}, {2, inf}}};
  for (size_t i = 0; i < bad.size(); ++i) {
    EXPECT_EQ(ReasonOf(GainCurve::Make(bad[i]).status()), "INVALID_CONFIG")
        << i;
  }
}

}  // namespace
}  // namespace tactus::internal::client
