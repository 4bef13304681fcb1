// Figures are decoded again and measured: what a reader would see.
#include <cmath>
#include <filesystem>
#include <limits>

#include "client/tools/plot/canvas.h"
#include "client/tools/plot/figure.h"
#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "opencv2/core.hpp"
#include "opencv2/imgcodecs.hpp"
#include "opencv2/imgproc.hpp"

namespace tactus::client {
namespace {

cv::Mat Decode(const Figure& figure) {
  auto png = EncodePng(figure);
  EXPECT_TRUE(png.ok()) << png.status();
  if (!png.ok()) return {};
  const std::vector<unsigned char> bytes(png->begin(), png->end());
  return cv::imdecode(bytes, cv::IMREAD_COLOR);
}

// Pixels of exactly this colour.
cv::Mat MaskOf(const cv::Mat& image, const Colour& colour) {
  cv::Mat mask;
  const cv::Scalar bgr(colour.blue, colour.green, colour.red);
  cv::inRange(image, bgr, bgr, mask);
  return mask;
}

// Centres of the spots of a colour, from left to right.
std::vector<cv::Point2d> Spots(const cv::Mat& image, const Colour& colour) {
  cv::Mat labels;
  cv::Mat stats;
  cv::Mat centres;
  const int count = cv::connectedComponentsWithStats(MaskOf(image, colour),
                                                     labels, stats, centres);
  std::vector<cv::Point2d> spots;
  for (int i = 1; i < count; ++i) {
    if (stats.at<int>(i, cv::CC_STAT_AREA) < 20) continue;
    spots.push_back({centres.at<double>(i, 0), centres.at<double>(i, 1)});
  }
  std::sort(spots.begin(), spots.end(),
            [](const auto& a, const auto& b) { return a.x < b.x; });
  return spots;
}

TEST(PlotPngTest, LogarithmicAxesSpaceDecadesEvenly) {
  ScatterPlot plot;
  plot.x = {.title = "x", .scale = AxisScale::kLog};
  plot.y = {.title = "y", .scale = AxisScale::kLog};
  plot.series = {{.name = "", .points = {{1, 0.1}, {10, 1}, {100, 10}}}};
  const auto spots = Spots(Decode(plot), SeriesColour(0));
  ASSERT_EQ(spots.size(), 3u);
  EXPECT_NEAR(spots[1].x - spots[0].x, spots[2].x - spots[1].x, 1);
  EXPECT_NEAR(spots[1].y - spots[0].y, spots[2].y - spots[1].y, 1);
  EXPECT_LT(spots[1].y, spots[0].y);
}

TEST(PlotPngTest, LinearAxesSpaceValuesEvenly) {
  ScatterPlot plot;
  plot.series = {{.name = "", .points = {{1, 9}, {2, 7}, {5, 1}}}};
  const auto spots = Spots(Decode(plot), SeriesColour(0));
  ASSERT_EQ(spots.size(), 3u);
  EXPECT_NEAR(3 * (spots[1].x - spots[0].x), spots[2].x - spots[1].x, 3);
  EXPECT_NEAR(3 * (spots[1].y - spots[0].y), spots[2].y - spots[1].y, 3);
}

TEST(PlotPngTest, BarsAreAsLongAsTheirValues) {
  BarChart chart;
  chart.sections = {{.name = "s", .groups = {"g"}}};
  chart.series = {{.name = "a", .values = {80}}, {.name = "b", .values = {20}}};
  const cv::Mat image = Decode(chart);
  double heights[2];
  for (int i = 0; i < 2; ++i) {
    cv::Mat labels;
    cv::Mat stats;
    cv::Mat centres;
    const int count = cv::connectedComponentsWithStats(
        MaskOf(image, SeriesColour(i)), labels, stats, centres);
    heights[i] = 0;
    for (int k = 1; k < count; ++k) {
      heights[i] =
          std::max<double>(heights[i], stats.at<int>(k, cv::CC_STAT_HEIGHT));
    }
  }
  EXPECT_NEAR(heights[0] / heights[1], 4, 0.1);
}

TEST(PlotPngTest, AnUnknownBarIsNotDrawnAsZeroOrAtAll) {
  BarChart chart;
  chart.sections = {{.name = "s", .groups = {"g", "h"}}};
  chart.series = {{.name = "a", .values = {50, std::nullopt}}};
  // One spot is the legend's.
  EXPECT_EQ(Spots(Decode(chart), SeriesColour(0)).size(), 2u);
}

TEST(PlotPngTest, CellsDarkenWithTheirShareOfTheRow) {
  const ConfusionMatrix matrix = {
      .title = "", .labels = {"A", "B"}, .counts = {{10, 0}, {300, 100}}};
  const cv::Mat image = Decode(matrix);
  // A full row share, 3/4 and 1/4 of one, in the largest even patches.
  const Colour full = {8, 69, 128};
  double previous = std::numeric_limits<double>::infinity();
  for (double share : {1.0, 0.75, 0.25}) {
    const Colour colour = Mix(kWhite, full, share);
    EXPECT_GT(cv::countNonZero(MaskOf(image, colour)), 4000) << share;
    EXPECT_LT(255 - colour.red, previous);
    previous = 255 - colour.red;
  }
}

TEST(PlotPngTest, LegendStandsAboveTheData) {
  LinePlot plot;
  plot.series = {{.name = "one", .x = {0, 1}, .y = {0, 0}, .markers = false},
                 {.name = "two", .x = {0, 1}, .y = {1, 1}, .markers = false}};
  const cv::Mat image = Decode(plot);
  // Each colour: its swatch, and further down its line.
  for (int i : {0, 1}) {
    EXPECT_EQ(Spots(image, SeriesColour(i)).size(), 2u);
  }
  const auto upper = Spots(image, SeriesColour(1));
  const auto lower = Spots(image, SeriesColour(0));
  const double legend = std::min(lower[0].y, lower[1].y);
  EXPECT_NEAR(std::min(upper[0].y, upper[1].y), legend, 2);
  EXPECT_GT(std::max(upper[0].y, upper[1].y), legend + 10);
}

TEST(PlotPngTest, SameFigureSameBytes) {
  const ConfusionMatrix matrix = {
      .title = "t", .labels = {"A", "B"}, .counts = {{1, 2}, {3, 4}}};
  EXPECT_EQ(*EncodePng(matrix), *EncodePng(matrix));
}

TEST(PlotPngTest, WhatCannotBeDrawnIsRefused) {
  const double nan = std::nan("");
  LinePlot uneven;
  uneven.series = {{.name = "a", .x = {1, 2}, .y = {1}}};
  LinePlot not_finite;
  not_finite.series = {{.name = "a", .x = {1}, .y = {nan}}};
  LinePlot below_zero;
  below_zero.y.scale = AxisScale::kLog;
  below_zero.series = {{.name = "a", .x = {1, 2}, .y = {0, 1}}};
  ScatterPlot no_points;
  no_points.series = {{.name = "a", .points = {}}};
  ScatterPlot too_many;
  too_many.series.assign(kMaxSeries + 1, {.name = "a", .points = {{1, 1}}});
  BarChart few_values;
  few_values.sections = {{.name = "s", .groups = {"g", "h"}}};
  few_values.series = {{.name = "a", .values = {1}}};
  BarChart negative;
  negative.sections = {{.name = "s", .groups = {"g"}}};
  negative.series = {{.name = "a", .values = {-1}}};
  BarChart no_groups;
  no_groups.series = {{.name = "a", .values = {}}};
  const ConfusionMatrix not_square = {
      .title = "", .labels = {"A", "B"}, .counts = {{1, 2}}};
  const ConfusionMatrix empty;
  ConfusionMatrix too_large;
  too_large.labels.assign(kMaxMatrixClasses + 1, "A");
  too_large.counts.assign(kMaxMatrixClasses + 1,
                          std::vector<int>(kMaxMatrixClasses + 1, 1));
  BarChart too_wide;
  too_wide.sections = {{.groups = std::vector<std::string>(kMaxBars + 1)}};
  too_wide.series = {
      {.values = std::vector<std::optional<double>>(kMaxBars + 1, 1.0)}};
  const std::vector<Figure> figures = {
      LinePlot{}, uneven,     not_finite, below_zero, no_points,
      too_many,   few_values, negative,   no_groups,  not_square,
      empty,      too_large,  too_wide};
  for (size_t i = 0; i < figures.size(); ++i) {
    EXPECT_EQ(ReasonOf(EncodePng(figures[i]).status()), "INVALID_CONFIG") << i;
  }
}

TEST(PlotPngTest, AFolderThatIsNotThereIsAnIoError) {
  const ConfusionMatrix matrix = {
      .title = "", .labels = {"A"}, .counts = {{1}}};
  const std::string path =
      (std::filesystem::path(testing::TempDir()) / "absent" / "a.png").string();
  EXPECT_EQ(ReasonOf(WritePng(matrix, path)), "IO");
}

}  // namespace
}  // namespace tactus::client
