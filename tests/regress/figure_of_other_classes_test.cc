// `trainctl evaluate --figures` drew the accuracy of the paper's best model as
// a dashed line into the figure of any recording, of cups for example.
#include "gtest/gtest.h"
#include "tools/trainctl/report/evaluate_figures.h"

namespace tactus::internal::client {
namespace {

Evaluation Of(std::vector<std::string> class_names, bool knows_motion) {
  Evaluation evaluation;
  evaluation.class_names = std::move(class_names);
  evaluation.final = {{0, {0.9, 0.1}}};
  evaluation.anytime.assign(kAnytimeCount, evaluation.final);
  if (knows_motion) evaluation.so_far.assign(kAnytimeCount, {0});
  return evaluation;
}

size_t DashedLines(const Evaluation& evaluation) {
  return AnytimePlot({"hmm", &evaluation, 5}, ComparableExperiment(evaluation))
      .references.size();
}

TEST(FigureOfOtherClassesTest, HasNoLineOfThePaper) {
  EXPECT_EQ(DashedLines(Of({"cup", "mug"}, false)), 0u);
  EXPECT_EQ(DashedLines(Of({"cup", "mug"}, true)), 0u);
  // Recordings with the paper's classes are no simulations either.
  EXPECT_EQ(DashedLines(Of({"HU", "HM", "SU", "SM"}, false)), 0u);
  EXPECT_EQ(DashedLines(Of({"HU", "HM", "SU", "SM"}, true)), 1u);
}

}  // namespace
}  // namespace tactus::internal::client
