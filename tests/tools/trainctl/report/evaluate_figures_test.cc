#include "tools/trainctl/report/evaluate_figures.h"

#include <cmath>

#include "core/base/random.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/text_boxes.h"

namespace tactus::internal::client {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

// Two classes, the first answered with probability `top`.
Outcome Answered(double top, bool right) {
  return {right ? 0 : 1, {top, 1 - top}};
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
      AnytimePlot({"HMM", &evaluation, 1.2}, Experiment::kSimulation);
  ASSERT_THAT(plot.series, SizeIs(1));
  EXPECT_THAT(plot.series[0].x, ElementsAre(0.1, 0.25, 0.5, 1.2));
  EXPECT_THAT(plot.series[0].y, ElementsAre(50, 50, 100, 100));
  // Wilson's intervals of 1 of 2 and of 2 of 2.
  EXPECT_NEAR(plot.series[0].low[0], 9.45, 0.01);
  EXPECT_NEAR(plot.series[0].high[0], 90.55, 0.01);
  EXPECT_NEAR(plot.series[0].low[3], 34.24, 0.01);
  EXPECT_EQ(plot.x.scale, AxisScale::kLog);
  EXPECT_EQ(plot.y.low, 0);
}

TEST(AnytimePlotTest, ShowsThePartsOfAFusedModel) {
  Evaluation evaluation = Sample();
  evaluation.anytime_hmm = evaluation.anytime;
  evaluation.anytime_lstm = evaluation.anytime;
  const LinePlot plot = AnytimePlot({"fused", &evaluation, 5}, std::nullopt);
  ASSERT_THAT(plot.series, SizeIs(3));
  EXPECT_EQ(plot.series[0].name, "fused");
  EXPECT_EQ(plot.series[1].name, "HMMs alone");
  EXPECT_EQ(plot.series[2].name, "LSTMs alone");
}

// Many contacts of which `wrong` are wrong at every time.
Evaluation Many(int wrong) {
  Evaluation evaluation;
  for (int i = 0; i < 2000; ++i) {
    evaluation.final.push_back(Answered(0.9, i >= wrong));
  }
  evaluation.anytime.assign(kAnytimeCount, evaluation.final);
  return evaluation;
}

TEST(AnytimePlotTest, TheAxisBeginsBelowEverythingShown) {
  const auto low = [](int wrong, std::optional<Experiment> paper) {
    const Evaluation evaluation = Many(wrong);
    return *AnytimePlot({"HMM", &evaluation, 5}, paper).y.low;
  };
  EXPECT_EQ(low(100, Experiment::kSimulation), 75);
  EXPECT_EQ(low(490, std::nullopt), 50);
  EXPECT_EQ(low(600, std::nullopt), 50);
  EXPECT_EQ(low(1500, std::nullopt), 0);
}

TEST(AnytimePlotTest, TheDashedLineIsThePapersBest) {
  const Evaluation evaluation = Sample();
  const auto line = [&](std::optional<Experiment> paper) {
    return AnytimePlot({"HMM", &evaluation, 5}, paper).references;
  };
  ASSERT_THAT(line(Experiment::kSimulation), SizeIs(1));
  EXPECT_EQ(line(Experiment::kSimulation)[0].y, 82.13);
  EXPECT_EQ(line(Experiment::kCody)[0].y, 83.75);
  EXPECT_EQ(line(Experiment::kCody)[0].name, "paper's best (HMM f+m+a, 1.2 s)");
  EXPECT_THAT(line(std::nullopt), IsEmpty());
}

TEST(DecisionPlotTest, CountsWhatIsDecidedByEachTime) {
  Evaluation evaluation = Many(0);
  evaluation.decisions.assign(4, std::nullopt);
  evaluation.decisions[0] = DecisionOutcome{.seconds = 0.5, .right = true};
  evaluation.decisions[1] = DecisionOutcome{.seconds = 1.01, .right = false};
  evaluation.decisions[3] = DecisionOutcome{.seconds = 2, .right = true};
  const LinePlot plot = DecisionPlot({"HMM", &evaluation, 2});
  ASSERT_THAT(plot.series, SizeIs(2));
  ASSERT_THAT(plot.series[0].x, SizeIs(101));
  const auto at = [&](int series, double seconds) {
    return plot.series[series].y[std::lround(seconds * 50)];
  };
  EXPECT_EQ(at(0, 0.4), 0);
  EXPECT_EQ(at(0, 0.5), 25);
  EXPECT_EQ(at(0, 1), 25);
  EXPECT_EQ(at(0, 1.1), 50);
  EXPECT_EQ(at(1, 1.1), 25);
  EXPECT_EQ(at(0, 2), 75);
  EXPECT_EQ(at(1, 2), 50);
}

TEST(ReliabilityPlotTest, ShowsPercentBesideTheDiagonal) {
  const Evaluation evaluation = Sample();
  const LinePlot plot = ReliabilityPlot({"HMM", &evaluation, 5});
  EXPECT_THAT(plot.diagonal, Not(IsEmpty()));
  ASSERT_THAT(plot.series, SizeIs(1));
  EXPECT_THAT(plot.series[0].x,
              ElementsAre(DoubleNear(80, 1e-9), DoubleNear(90, 1e-9)));
  EXPECT_THAT(plot.series[0].y, ElementsAre(100, 100));
  // Bins 12 to 14; the axis begins with the first of them.
  EXPECT_DOUBLE_EQ(*plot.x.low, 80);
  EXPECT_THAT(plot.counts.counts, ElementsAre(1, 1, 0));
  EXPECT_THAT(plot.counts.edges, SizeIs(4));
}

TEST(ReliabilityPlotTest, BinsOfFewerThanTenContactsAreMarked) {
  Evaluation evaluation;
  evaluation.final.assign(9, Answered(0.75, true));
  evaluation.final.insert(evaluation.final.end(), 10, Answered(0.9, true));
  const LinePlot plot = ReliabilityPlot({"HMM", &evaluation, 5});
  EXPECT_THAT(plot.series[0].few, ElementsAre(true, false));
  EXPECT_EQ(plot.few_name, "fewer than 10 contacts");
}

TEST(ReliabilityPlotTest, TextsDoNotOverlap) {
  Random random(5);
  Evaluation evaluation;
  for (int i = 0; i < 3000; ++i) {
    const double top = random.Uniform(0.25, 1);
    evaluation.final.push_back(Answered(top, random.Uniform() < top));
  }
  evaluation.anytime.assign(kAnytimeCount, evaluation.final);
  const NamedEvaluation shown = {"fused", &evaluation, 5};
  for (const LinePlot& plot :
       {ReliabilityPlot(shown), AnytimePlot(shown, Experiment::kCody)}) {
    const auto script = ScriptOf(plot);
    ASSERT_TRUE(script.ok()) << script.status();
    EXPECT_EQ(CoveredTexts(*script), "");
  }
}

}  // namespace
}  // namespace tactus::internal::client
