#include "client/tools/trainctl/evaluate_figures.h"

#include <cmath>

#include "core/base/random.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::client {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

// Two classes, the first answered with probability `top`.
Outcome Answered(double top, bool right) {
  return {right ? 0 : 1, {top, 1 - top}};
}

TEST(ReliabilityBinsTest, BinsHoldMeansOfTheirOutcomes) {
  const std::vector<Outcome> outcomes = {
      Answered(0.95, true), Answered(0.97, true), Answered(0.99, false),
      Answered(0.62, false), Answered(1.0, true)};
  const auto bins = ReliabilityBins(outcomes);
  ASSERT_THAT(bins, SizeIs(2));
  EXPECT_EQ(bins[0].count, 1);
  EXPECT_DOUBLE_EQ(bins[0].mean_probability, 0.62);
  EXPECT_EQ(bins[0].accuracy, 0);
  EXPECT_EQ(bins[1].count, 4);
  EXPECT_DOUBLE_EQ(bins[1].mean_probability, (0.95 + 0.97 + 0.99 + 1) / 4);
  EXPECT_EQ(bins[1].accuracy, 0.75);
}

TEST(ReliabilityBinsTest, TheyAreTheBinsOfTheCalibrationError) {
  Random random(5);
  std::vector<Outcome> outcomes;
  for (int i = 0; i < 400; ++i) {
    const double top = random.Uniform(0.5, 1);
    outcomes.push_back(Answered(top, random.Uniform() < 0.8));
  }
  double error = 0;
  for (const ReliabilityBin& bin : ReliabilityBins(outcomes)) {
    error += bin.count * std::abs(bin.accuracy - bin.mean_probability) / 400;
  }
  EXPECT_THAT(error, DoubleNear(ExpectedCalibrationError(outcomes), 1e-12));
}

Evaluation Sample() {
  Evaluation evaluation;
  evaluation.class_names = {"A", "B"};
  evaluation.final = {Answered(0.9, true), Answered(0.8, true)};
  for (int i = 0; i < kAnytimeCount; ++i) {
    evaluation.anytime.push_back({Answered(0.9, true), Answered(0.8, i >= 2)});
  }
  return evaluation;
}

TEST(AnytimePlotTest, ShowsPercentAtEachTimeUpToTheLongestContact) {
  const Evaluation evaluation = Sample();
  const LinePlot plot =
      AnytimePlot({{"HMM", &evaluation, 1.2}}, Experiment::kSimulation);
  ASSERT_THAT(plot.series, SizeIs(1));
  EXPECT_THAT(plot.series[0].x, ElementsAre(0.1, 0.25, 0.5, 1.2));
  EXPECT_THAT(plot.series[0].y, ElementsAre(50, 50, 100, 100));
  EXPECT_EQ(plot.x.scale, AxisScale::kLog);
}

TEST(AnytimePlotTest, TheDashedLineIsThePapersBest) {
  const Evaluation evaluation = Sample();
  const auto line = [&](std::optional<Experiment> paper) {
    return AnytimePlot({{"HMM", &evaluation, 5}}, paper).references;
  };
  ASSERT_THAT(line(Experiment::kSimulation), SizeIs(1));
  EXPECT_EQ(line(Experiment::kSimulation)[0].y, 82.13);
  EXPECT_EQ(line(Experiment::kCody)[0].y, 83.75);
  EXPECT_EQ(line(Experiment::kCody)[0].name, "paper's best (HMM f+m+a, 1.2 s)");
  EXPECT_THAT(line(std::nullopt), IsEmpty());
}

TEST(ReliabilityPlotTest, ShowsPercentBesideTheDiagonal) {
  const Evaluation evaluation = Sample();
  const LinePlot plot = ReliabilityPlot({{"HMM", &evaluation, 5}});
  EXPECT_TRUE(plot.diagonal);
  ASSERT_THAT(plot.series, SizeIs(1));
  EXPECT_THAT(plot.series[0].x,
              ElementsAre(DoubleNear(80, 1e-9), DoubleNear(90, 1e-9)));
  EXPECT_THAT(plot.series[0].y, ElementsAre(100, 100));
  EXPECT_TRUE(EncodePng(plot).ok());
}

}  // namespace
}  // namespace tactus::client
