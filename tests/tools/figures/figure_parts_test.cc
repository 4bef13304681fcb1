// The parts of charts that are computed here rather than by gnuplot: ends and
// labels of axes, places of labels, the Pareto front.
#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/random.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tools/figures/axis.h"
#include "tools/figures/label_places.h"
#include "tools/figures/pareto.h"
#include "tools/figures/sheet.h"

namespace tactus::internal::client {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(AxisTest, GivenEndsHoldUnlessTheyHideValues) {
  const Axis axis = {.title = "accuracy", .low = 75, .high = 100};
  EXPECT_EQ(RangeShown(axis, {80, 99}).low, 75);
  EXPECT_EQ(RangeShown(axis, {80, 99}).high, 100);
  EXPECT_LT(RangeShown(axis, {60, 99}).low, 60);
  const Axis free = {.scale = AxisScale::kLog};
  const Range range = RangeShown(free, {0.1, 10});
  EXPECT_LT(range.low, 0.1);
  EXPECT_GT(range.low, 0.05);
  EXPECT_GT(range.high, 10);
  const Range one_value = RangeShown(Axis(), {3});
  EXPECT_LT(one_value.low, 3);
  EXPECT_GT(one_value.high, 3);
}

TEST(AxisTest, LogarithmicLabelsAreRoundAndFew) {
  EXPECT_THAT(LogTicks({0.09, 11}), ElementsAre(0.1, 1, 10));
  EXPECT_THAT(LogTicks({180, 4500}), ElementsAre(200, 500, 1000, 2000));
  EXPECT_THAT(LogTicks({1, 100}), ElementsAre(1, 2, 5, 10, 20, 50, 100));
  for (int decades = 1; decades <= 30; ++decades) {
    for (const double low : {1e-14, 3e-7, 0.2, 170.0}) {
      const auto ticks = LogTicks({low, low * std::pow(10, decades)});
      EXPECT_GE(ticks.size(), 2u) << low << ' ' << decades;
      EXPECT_LE(ticks.size(), 11u) << low << ' ' << decades;
    }
  }
}

// Labels of a logarithmic axis over `range`, as gnuplot gets them.
std::string LogLabels(const Range& range) {
  GnuplotScript script(800, 600);
  SetAxis('x', {.scale = AxisScale::kLog}, range, script);
  const size_t at = script.text().find("set xtics (");
  return script.text().substr(at, script.text().find(')', at) - at);
}

TEST(AxisTest, LabelsOfUpToSixDigitsAreNumbers) {
  EXPECT_THAT(LogLabels({900, 110'000}), HasSubstr("'10000' 10000"));
  EXPECT_THAT(LogLabels({900, 110'000}), HasSubstr("'100000' 100000"));
  EXPECT_THAT(LogLabels({0.001, 1}), HasSubstr("'0.001' 0.001"));
  EXPECT_THAT(LogLabels({1, 1e7}), HasSubstr("'10⁶' 1000000"));
  EXPECT_THAT(LogLabels({1e-9, 1}), HasSubstr("'10⁻⁹' 1e-09"));
}

constexpr Box kArea = {140, 100, 1100, 760};

TEST(LabelPlacesTest, ASingleLabelStandsBesideItsPoint) {
  const auto places = PlaceLabels({{{500, 400}, "label"}}, {}, kArea, 20);
  ASSERT_EQ(places.size(), 1u);
  EXPECT_GT(places[0].box.left, 500);
  EXPECT_LT(places[0].box.left, 530);
  EXPECT_FALSE(places[0].leader);
}

TEST(LabelPlacesTest, LabelsCoverNeitherEachOtherNorPoints) {
  Random random(4);
  std::vector<LabelledPoint> points;
  std::vector<Box> markers;
  for (int i = 0; i < 25; ++i) {
    const Point at = {random.Uniform(200, 1000), random.Uniform(150, 700)};
    points.push_back({at, absl::StrCat("variant ", i)});
    markers.push_back({at.x - 14, at.y - 14, at.x + 14, at.y + 14});
  }
  const auto places = PlaceLabels(points, markers, kArea, 20);
  ASSERT_EQ(places.size(), points.size());
  for (size_t i = 0; i < places.size(); ++i) {
    const Box& box = places[i].box;
    EXPECT_GE(box.left, kArea.left);
    EXPECT_LE(box.right, kArea.right);
    EXPECT_GE(box.top, kArea.top);
    EXPECT_LE(box.bottom, kArea.bottom);
    for (size_t j = 0; j < i; ++j) {
      EXPECT_EQ(Overlap(box, places[j].box), 0) << i << ' ' << j;
    }
    for (const Box& marker : markers) EXPECT_EQ(Overlap(box, marker), 0) << i;
  }
}

// A label across the edge is cut off; one that covers something can be read.
TEST(LabelPlacesTest, NoLabelIsCutOffHoweverCrowdedTheEdge) {
  const std::vector<Box> wall = {{300, 100, 1100, 760}};
  for (const double x : {1000.0, 1050.0, 1090.0}) {
    const auto places =
        PlaceLabels({{{x, 400}, "a label of some length"}}, wall, kArea, 20);
    EXPECT_LE(places[0].box.right, kArea.right) << x;
  }
}

TEST(LabelPlacesTest, ALabelThatStandsApartHasALeader) {
  // Two points at one place, walls beside it: the second label has to move up.
  const std::vector<Box> walls = {{505, 300, 1100, 500}, {140, 300, 495, 500}};
  const auto places = PlaceLabels({{{500, 400}, "label"}}, walls, kArea, 20);
  ASSERT_TRUE(places[0].leader);
  EXPECT_LT(std::abs(places[0].leader->from.y - 400), 20);
}

TEST(SheetTest, LegendsWrapBeforeTheEdge) {
  GnuplotScript script(800, 600);
  const std::vector<LegendEntry> one = {{.name = "HMM alone"}};
  const std::vector<LegendEntry> many(5, one[0]);
  const double first = AddLegend(one, {100, 50}, 700, script);
  const double wrapped = AddLegend(many, {100, 50}, 700, script);
  // Two of them fit into a row.
  EXPECT_DOUBLE_EQ(wrapped - 50, 3 * (first - 50));
  EXPECT_EQ(AddLegend({}, {100, 50}, 700, script), 50);
}

// True if no other point is at least as good on both axes and better on one.
bool IsOnFront(const std::vector<ScatterPoint>& points, size_t i, double sign_x,
               double sign_y) {
  for (size_t j = 0; j < points.size(); ++j) {
    const double x = sign_x * (points[j].x - points[i].x);
    const double y = sign_y * (points[j].y - points[i].y);
    if (x >= 0 && y >= 0 && (x > 0 || y > 0)) return false;
    if (x == 0 && y == 0 && j < i) return false;
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
      std::ranges::sort(expected, {}, [&](int i) { return points[i].x; });
      EXPECT_EQ(ParetoFront(points, better_x, better_y), expected);
    }
  }
}

}  // namespace
}  // namespace tactus::internal::client
