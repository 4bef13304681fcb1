#include <limits>

#include "client/tools/plot/pareto.h"
#include "client/tools/plot/ticks.h"
#include "core/base/errors.h"
#include "core/base/random.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::client {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::string> Labels(const PlotScale& scale) {
  std::vector<std::string> labels;
  for (const Tick& tick : scale.ticks) labels.push_back(tick.label);
  return labels;
}

PlotScale Scale(const Axis& axis, double low, double high, int count = 5) {
  auto scale = MakeScale(axis, {low, high}, count);
  EXPECT_TRUE(scale.ok()) << scale.status();
  return scale.ok() ? *std::move(scale) : PlotScale{};
}

TEST(TicksTest, LinearTicksAreRoundAndEncloseTheData) {
  EXPECT_THAT(Labels(Scale({}, 0.13, 4.9)),
              ElementsAre("0", "1", "2", "3", "4", "5"));
  EXPECT_THAT(Labels(Scale({}, -0.31, 0.42)),
              ElementsAre("-0.4", "-0.2", "0", "0.2", "0.4", "0.6"));
  EXPECT_THAT(Labels(Scale({}, 0, 0.9)),
              ElementsAre("0", "0.2", "0.4", "0.6", "0.8", "1.0"));
  EXPECT_THAT(Labels(Scale({}, 0, 12000)),
              ElementsAre("0", "5000", "10000", "15000"));
  EXPECT_THAT(Labels(Scale({}, 0, 5e6)),
              ElementsAre("0", "1e6", "2e6", "3e6", "4e6", "5e6"));
}

TEST(TicksTest, GivenEndsAreKept) {
  const PlotScale scale = Scale({.low = 0, .high = 100}, 31, 67);
  EXPECT_EQ(scale.low, 0);
  EXPECT_EQ(scale.high, 100);
  EXPECT_THAT(Labels(scale), ElementsAre("0", "20", "40", "60", "80", "100"));
}

TEST(TicksTest, DataBeyondAGivenEndAreNotCutOff) {
  const PlotScale scale = Scale({.low = 50, .high = 100}, 31, 120);
  EXPECT_LE(scale.low, 31);
  EXPECT_GE(scale.high, 120);
}

TEST(TicksTest, OneValueGetsARangeAroundIt) {
  for (double value : {0.0, -3.0, 7e-5}) {
    const PlotScale scale = Scale({}, value, value);
    EXPECT_LT(scale.low, value);
    EXPECT_GT(scale.high, value);
    EXPECT_GE(scale.ticks.size(), 2u);
  }
}

TEST(TicksTest, LogarithmicTicksAreOneTwoFiveOfEachDecade) {
  const Axis axis = {.scale = AxisScale::kLog};
  EXPECT_THAT(Labels(Scale(axis, 0.1, 5)),
              ElementsAre("0.1", "0.2", "0.5", "1", "2", "5"));
  EXPECT_THAT(
      Labels(Scale(axis, 0.3, 70)),
      ElementsAre("0.2", "0.5", "1", "2", "5", "10", "20", "50", "100"));
}

TEST(TicksTest, ALogarithmicAxisBelowADecadeHasEvenTicks) {
  const Axis axis = {.scale = AxisScale::kLog, .low = 5.4, .high = 9.1};
  EXPECT_THAT(Labels(Scale(axis, 6, 7)), ElementsAre("6", "7", "8", "9"));
  EXPECT_THAT(Labels(Scale({.scale = AxisScale::kLog}, 31, 92)),
              ElementsAre("20", "40", "60", "80", "100"));
}

// Labels that take up ten units of an axis of a hundred.
std::vector<std::string> Thinned(PlotScale scale) {
  ThinTicks(
      100, [](const Tick&) { return 10.0; }, scale);
  return Labels(scale);
}

TEST(TicksTest, LabelsAreAsManyAsThereIsRoomFor) {
  const Axis axis = {.scale = AxisScale::kLog};
  EXPECT_THAT(Thinned(Scale(axis, 1, 100)),
              ElementsAre("1", "2", "5", "10", "20", "50", "100"));
  EXPECT_THAT(Thinned(Scale(axis, 0.01, 1000)),
              ElementsAre("0.01", "0.1", "1", "10", "100", "1000"));
  EXPECT_THAT(Thinned(Scale(axis, 1e-7, 1e5)),
              ElementsAre("1e-6", "0.0001", "0.01", "1", "100", "10000"));
  EXPECT_THAT(Thinned(Scale(axis, 1e-23, 1e4)),
              ElementsAre("1e-21", "1e-18", "1e-15", "1e-12", "1e-9", "1e-6",
                          "0.001", "1", "1000"));
  EXPECT_THAT(
      Thinned(Scale({}, 0, 20, 20)),
      ElementsAre("0", "2", "4", "6", "8", "10", "12", "14", "16", "18", "20"));
}

TEST(TicksTest, DroppedLabelsLeaveMarks) {
  PlotScale scale = Scale({.scale = AxisScale::kLog}, 1, 1000);
  ThinTicks(
      3, [](const Tick&) { return 1.0; }, scale);
  EXPECT_THAT(Labels(scale), ElementsAre("1", "10", "100", "1000"));
  EXPECT_EQ(scale.minor_ticks.size(), 3u * 8);
  ThinTicks(
      3, [](const Tick&) { return 2.0; }, scale);
  EXPECT_THAT(Labels(scale), ElementsAre("1", "100"));
  EXPECT_THAT(scale.minor_ticks, ElementsAre(10, 1000));
}

TEST(TicksTest, PositionsAreLinearOrLogarithmic) {
  EXPECT_DOUBLE_EQ(Scale({.low = -1, .high = 3}, 0, 1).Position(2), 0.75);
  const Axis axis = {.scale = AxisScale::kLog, .low = 0.1, .high = 1000};
  EXPECT_DOUBLE_EQ(Scale(axis, 1, 2).Position(1), 0.25);
}

TEST(TicksTest, ChosenTicksReplaceTheRoundOnes) {
  const PlotScale scale =
      Scale({.scale = AxisScale::kLog, .ticks = {0.1, 0.25, 1.2, 9}}, 0.1, 5);
  EXPECT_THAT(Labels(scale), ElementsAre("0.1", "0.25", "1.2"));
  EXPECT_THAT(scale.minor_ticks, IsEmpty());
  EXPECT_EQ(Thinned(scale), Labels(scale));
}

TEST(TicksTest, ImpossibleAxesAreRefused) {
  const double infinity = std::numeric_limits<double>::infinity();
  const Axis log = {.scale = AxisScale::kLog};
  const std::pair<Axis, DataRange> wrong[] = {
      {log, {0, 1}},
      {log, {-1, 1}},
      {{}, {0, infinity}},
      {{.low = std::nan("")}, {0, 1}},
      {{.low = 2, .high = 1}, {1.2, 1.8}},
  };
  for (const auto& [axis, data] : wrong) {
    EXPECT_EQ(ReasonOf(MakeScale(axis, data, 5).status()), "INVALID_CONFIG");
  }
}

// Not beaten: for every other point, better on some axis or equal on both.
bool IsOnFront(const std::vector<ScatterPoint>& points, size_t i, double sign_x,
               double sign_y) {
  for (size_t j = 0; j < points.size(); ++j) {
    const double dx = sign_x * (points[j].x - points[i].x);
    const double dy = sign_y * (points[j].y - points[i].y);
    if (dx >= 0 && dy >= 0 && (dx > 0 || dy > 0)) return false;
    if (dx == 0 && dy == 0 && j < i) return false;
  }
  return true;
}

TEST(ParetoTest, AgreesWithComparingAllPairs) {
  Random random(3);
  for (Better better_x : {Better::kLow, Better::kHigh}) {
    for (Better better_y : {Better::kLow, Better::kHigh}) {
      std::vector<ScatterPoint> points(60);
      for (ScatterPoint& point : points) {
        // Few values, so that there are ties.
        point.x = std::floor(12 * random.Uniform());
        point.y = std::floor(12 * random.Uniform());
      }
      std::vector<int> expected;
      for (size_t i = 0; i < points.size(); ++i) {
        if (IsOnFront(points, i, better_x == Better::kLow ? -1 : 1,
                      better_y == Better::kLow ? -1 : 1)) {
          expected.push_back(static_cast<int>(i));
        }
      }
      std::sort(expected.begin(), expected.end(),
                [&](int a, int b) { return points[a].x < points[b].x; });
      EXPECT_EQ(ParetoFront(points, better_x, better_y), expected);
    }
  }
}

}  // namespace
}  // namespace tactus::client
