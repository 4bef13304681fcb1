// Charts are drawn, decoded and measured: what a reader would see.
#include "tools/figures/figure.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/png_image.h"

namespace tactus::internal::client {
namespace {

namespace fs = std::filesystem;

PngImage Drawn(const Figure& figure) {
  const std::string path =
      (fs::path(::testing::TempDir()) / "figure_test.png").string();
  const absl::Status status = DrawFigure(figure, path);
  EXPECT_TRUE(status.ok()) << status;
  std::ifstream file(path, std::ios::binary);
  return DecodePng({std::istreambuf_iterator<char>(file), {}});
}

// Patches of a series' colour below the heading, where the data are.
std::vector<Spot> DataSpots(const PngImage& image, int series,
                            int heading = 120) {
  std::vector<Spot> spots = Spots(image, ColourOf(SeriesColour(series)));
  std::erase_if(spots, [&](const Spot& spot) { return spot.top < heading; });
  return spots;
}

TEST(FigureTest, LogarithmicAxesSpaceDecadesEvenly) {
  ScatterPlot plot;
  plot.x = {.title = "x", .scale = AxisScale::kLog};
  plot.y = {.title = "y", .scale = AxisScale::kLog};
  plot.series = {{.name = "a", .points = {{1, 0.1}, {10, 1}, {100, 10}}}};
  const auto spots = DataSpots(Drawn(plot), 0);
  ASSERT_EQ(spots.size(), 3u);
  EXPECT_NEAR(spots[1].x() - spots[0].x(), spots[2].x() - spots[1].x(), 1);
  EXPECT_NEAR(spots[1].y() - spots[0].y(), spots[2].y() - spots[1].y(), 1);
  EXPECT_LT(spots[1].y(), spots[0].y());
}

TEST(FigureTest, LinearAxesSpaceValuesEvenly) {
  ScatterPlot plot;
  plot.series = {{.name = "a", .points = {{1, 9}, {2, 7}, {5, 1}}}};
  const auto spots = DataSpots(Drawn(plot), 0);
  ASSERT_EQ(spots.size(), 3u);
  EXPECT_NEAR(3 * (spots[1].x() - spots[0].x()), spots[2].x() - spots[1].x(),
              3);
  EXPECT_NEAR(3 * (spots[1].y() - spots[0].y()), spots[2].y() - spots[1].y(),
              3);
}

TEST(FigureTest, BarsAreAsLongAsTheirValues) {
  BarChart chart;
  chart.series = {"a", "b"};
  chart.sections = {{"s", {{"g", {Bar{80}, Bar{20}}}}}};
  const PngImage image = Drawn(chart);
  const auto first = DataSpots(image, 0);
  const auto second = DataSpots(image, 1);
  ASSERT_EQ(first.size(), 1u);
  ASSERT_EQ(second.size(), 1u);
  EXPECT_NEAR(1. * first[0].height() / second[0].height(), 4, 0.1);
}

TEST(FigureTest, IntervalsHideNoPartOfTheirBar) {
  BarChart chart;
  chart.series = {"a"};
  chart.sections = {{"s", {{"g", {Bar{50, 45, 55}}}}}};
  const PngImage image = Drawn(chart);
  const auto bars = DataSpots(image, 0);
  ASSERT_FALSE(bars.empty());
  const int middle = static_cast<int>(bars[0].x());
  // The line of the interval is above the bar's end and on it.
  for (const int y : {bars[0].top - 12, bars[0].top + 2, bars[0].top + 6}) {
    EXPECT_NE(image.At(middle, y), 0xffffffu) << y - bars[0].top;
  }
}

TEST(FigureTest, PowersOfTenFitBesideTheAxis) {
  LinePlot plot;
  plot.y = {.title = "error", .scale = AxisScale::kLog};
  plot.series = {{.name = "a", .x = {1, 2}, .y = {1e-14, 1}}};
  const PngImage image = Drawn(plot);
  EXPECT_EQ(Ink(image, 0, 0, 4, image.height).pixels, 0);
  // The title is left of the labels.
  EXPECT_GT(Ink(image, 4, 120, 50, image.height).pixels, 100);
}

TEST(FigureTest, MarkersOfManySeriesStaySmall) {
  LinePlot plot;
  for (int i = 0; i < 6; ++i) {
    const double place = i;
    plot.series.push_back({.name = "a", .x = {place}, .y = {place}});
  }
  const PngImage image = Drawn(plot);
  const auto first = DataSpots(image, 0);
  const auto last = DataSpots(image, 5);
  ASSERT_EQ(first.size(), 1u);
  ASSERT_EQ(last.size(), 1u);
  EXPECT_LT(last[0].height(), 1.6 * first[0].height());
}

TEST(FigureTest, AMatrixIsAsWideAsItsSubtitle) {
  const ConfusionMatrix matrix = {
      .title = "t",
      .subtitle = "1422 of 1835 right: 77.5 % (95 %: 75.5 to 79.3)",
      .labels = {"HU", "HM"},
      .counts = {{1, 0}, {0, 1}}};
  const auto script = ScriptOf(matrix);
  ASSERT_TRUE(script.ok()) << script.status();
  EXPECT_THAT(script->text(), testing::HasSubstr(matrix.subtitle));
}

TEST(FigureTest, AnUnknownBarIsNotDrawn) {
  BarChart chart;
  chart.series = {"a"};
  chart.sections = {{"s", {{"g", {Bar{50}}}, {"h", {std::nullopt}}}},
                    {"t", {{"g", {std::nullopt}}}}};
  EXPECT_EQ(DataSpots(Drawn(chart), 0).size(), 1u);
}

TEST(FigureTest, CellsDarkenWithTheirFractionOfTheRow) {
  const ConfusionMatrix matrix = {
      .title = "t", .labels = {"A", "B"}, .counts = {{10, 0}, {300, 100}}};
  const PngImage image = Drawn(matrix);
  // Dark blue at 1; 3/4 and 1/4 of the way to it from white.
  for (const char* colour : {"#0b4a83", "#4877a2", "#c2d2e0"}) {
    EXPECT_EQ(Spots(image, ColourOf(colour), 4000).size(), 1u) << colour;
  }
}

TEST(FigureTest, TheLegendStandsAboveTheData) {
  LinePlot plot;
  plot.series = {{.name = "one", .x = {0, 1}, .y = {0, 0}},
                 {.name = "two", .x = {0, 1}, .y = {1, 1}}};
  const PngImage image = Drawn(plot);
  // Each colour: its sample, and further down its line.
  double samples[2];
  for (const int i : {0, 1}) {
    const auto spots = Spots(image, ColourOf(SeriesColour(i)), 100);
    ASSERT_EQ(spots.size(), 2u) << i;
    samples[i] = std::min(spots[0].y(), spots[1].y());
    EXPECT_GT(std::max(spots[0].y(), spots[1].y()), samples[i] + 30) << i;
  }
  EXPECT_NEAR(samples[0], samples[1], 2);
}

TEST(FigureTest, CountsAreBarsBelowThePlot) {
  LinePlot plot;
  plot.x = {.title = "x", .low = 0, .high = 2};
  plot.series = {{.name = "one", .x = {0.5, 1.5}, .y = {3, 4}}};
  plot.counts = {"contacts", {0, 1, 2}, {10, 1000}};
  const PngImage image = Drawn(plot);
  const auto bars = Spots(image, ColourOf("#b5b5b5"), 1000);
  ASSERT_EQ(bars.size(), 2u);
  // From 0.5 up on a logarithmic axis.
  EXPECT_NEAR(1. * bars[1].height() / bars[0].height(),
              std::log(1000 / 0.5) / std::log(10 / 0.5), 0.1);
  const auto points = DataSpots(image, 0, 160);
  for (const Spot& point : points) EXPECT_LT(point.bottom, bars[1].top);
}

TEST(FigureTest, EachCountStandsOnItsBar) {
  LinePlot plot;
  plot.x = {.title = "x", .low = 0, .high = 2};
  plot.series = {{.name = "one", .x = {0.5, 1.5}, .y = {3, 4}}};
  plot.counts = {"contacts", {0, 1, 2}, {10, 2000}};
  const auto script = ScriptOf(plot);
  ASSERT_TRUE(script.ok()) << script.status();
  const auto bars = Spots(Drawn(plot), ColourOf("#b5b5b5"), 1000);
  ASSERT_EQ(bars.size(), 2u);
  const auto& texts = script->text_boxes();
  for (const size_t i : {0, 1}) {
    const Box& count = texts[texts.size() - 2 + i];
    EXPECT_NEAR((count.left + count.right) / 2, bars[i].x(), 2) << i;
    EXPECT_NEAR(count.bottom, bars[i].top, 8) << i;
  }
}

// Pixels of the first series' colour in the column halfway between two points.
int LineBetween(const PngImage& image, const Spot& a, const Spot& b) {
  const int x = static_cast<int>((a.x() + b.x()) / 2);
  int pixels = 0;
  for (int y = 150; y < image.height; ++y) {
    pixels += image.At(x, y) == ColourOf(SeriesColour(0));
  }
  return pixels;
}

TEST(FigureTest, NoLineLeadsToAPointOfFewObservations) {
  LinePlot plot;
  plot.few_name = "few";
  plot.x = {.title = "x", .low = 0, .high = 5};
  plot.y = {.title = "y", .low = 0, .high = 10};
  plot.series = {
      {.name = "a", .x = {1, 2, 3, 4}, .y = {5, 5, 5, 5}, .markers = false}};
  const PngImage joined = Drawn(plot);
  // The markers alone, to know where the points are.
  plot.series[0].markers = true;
  plot.series[0].few = {true, true, true, true};
  const auto points = DataSpots(Drawn(plot), 0, 150);
  ASSERT_EQ(points.size(), 4u);
  EXPECT_GT(LineBetween(joined, points[1], points[2]), 0);
  plot.series[0].few = {false, false, true, false};
  const PngImage image = Drawn(plot);
  EXPECT_GT(LineBetween(image, points[0], points[1]), 0);
  EXPECT_EQ(LineBetween(image, points[1], points[2]), 0);
  EXPECT_EQ(LineBetween(image, points[2], points[3]), 0);
  // The marker is white inside.
  EXPECT_EQ(image.At(static_cast<int>(points[2].x()),
                     static_cast<int>(points[2].y())),
            0xffffffu);
}

TEST(FigureTest, TheTitleOfGroupsStandsBelowThem) {
  BarChart chart;
  chart.series = {"a"};
  chart.sections = {{"s", {{"g", {Bar{50}}}}}};
  const int height = Drawn(chart).height;
  chart.x_title = "features";
  const PngImage image = Drawn(chart);
  EXPECT_GT(image.height, height);
  EXPECT_GT(Ink(image, 600, height, 900, image.height).pixels, 100);
}

TEST(FigureTest, WhatCannotBeDrawnIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  LinePlot uneven;
  uneven.series = {{.name = "a", .x = {1, 2}, .y = {1}}};
  LinePlot one_sided;
  one_sided.series = {{.name = "a", .x = {1}, .y = {1}, .low = {1}}};
  LinePlot few_of_another;
  few_of_another.series = {{.name = "a", .x = {1}, .y = {1}, .few = {1, 1}}};
  LinePlot not_finite;
  not_finite.series = {{.name = "a", .x = {1}, .y = {nan}}};
  LinePlot below_zero;
  below_zero.y.scale = AxisScale::kLog;
  below_zero.series = {{.name = "a", .x = {1, 2}, .y = {0, 1}}};
  LinePlot few_edges;
  few_edges.series = {{.name = "a", .x = {1}, .y = {1}}};
  few_edges.counts = {"n", {0, 1}, {5, 6}};
  ScatterPlot no_points;
  no_points.series = {{.name = "a", .points = {}}};
  ScatterPlot too_many;
  too_many.series.assign(kMaxSeries + 1, {.name = "a", .points = {{1, 1}}});
  BarChart few_bars;
  few_bars.series = {"a", "b"};
  few_bars.sections = {{"s", {{"g", {Bar{1}}}}}};
  BarChart negative;
  negative.series = {"a"};
  negative.sections = {{"s", {{"g", {Bar{-1}}}}}};
  BarChart no_groups;
  no_groups.series = {"a"};
  no_groups.sections = {{"s", {}}};
  BarChart too_wide = no_groups;
  too_wide.sections[0].groups.assign(kMaxBarsInRow + 1, {"g", {Bar{1}}});
  const ConfusionMatrix not_square = {
      .title = "", .labels = {"A", "B"}, .counts = {{1, 2}}};
  ConfusionMatrix too_large;
  too_large.labels.assign(kMaxMatrixClasses + 1, "A");
  too_large.counts.assign(kMaxMatrixClasses + 1,
                          std::vector<int>(kMaxMatrixClasses + 1, 1));
  const std::vector<Figure> figures = {
      LinePlot{}, uneven,     one_sided,         few_of_another,
      not_finite, below_zero, few_edges,         no_points,
      too_many,   few_bars,   negative,          no_groups,
      not_square, too_wide,   ConfusionMatrix{}, too_large};
  for (size_t i = 0; i < figures.size(); ++i) {
    EXPECT_EQ(ReasonOf(DrawFigure(figures[i], "/nowhere/a.png")),
              "INVALID_CONFIG")
        << i;
  }
}

}  // namespace
}  // namespace tactus::internal::client
