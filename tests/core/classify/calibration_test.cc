#include "core/classify/calibration.h"

#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "tests/support/small_model.h"

namespace tactus::internal {
namespace {

constexpr double kNoBias[2] = {0, 0};
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(CalibrationAtTest, HoldsOutsideAndInterpolatesInLogFrames) {
  const Calibration c = testing::SmallModel().calibration;
  EXPECT_DOUBLE_EQ(CalibrationAt(c, 1).hmm_inverse_temperature, 0.5);
  EXPECT_DOUBLE_EQ(CalibrationAt(c, 10).hmm_inverse_temperature, 0.5);
  // 10^1.5 lies half way between 10 and 100 in the logarithm.
  EXPECT_NEAR(CalibrationAt(c, std::pow(10, 1.5)).hmm_inverse_temperature, 0.3,
              1e-12);
  EXPECT_DOUBLE_EQ(CalibrationAt(c, 100).hmm_inverse_temperature, 0.1);
  EXPECT_DOUBLE_EQ(CalibrationAt(c, 1e9).hmm_inverse_temperature, 0.1);
}

TEST(TemperedPosteriorTest, IsBayesRuleAtTemperatureOne) {
  const double log_prior[] = {std::log(0.2), std::log(0.8)};
  const double score[] = {std::log(0.3), std::log(0.1)};
  double p[2];
  TemperedPosterior(log_prior, score, 1, kNoBias, p);
  EXPECT_NEAR(p[0], 0.06 / 0.14, 1e-15);
  EXPECT_NEAR(p[1], 0.08 / 0.14, 1e-15);
}

TEST(TemperedPosteriorTest, LargeScoresNeitherOverflowNorVanish) {
  const double log_prior[] = {std::log(0.5), std::log(0.5)};
  double p[2];
  const double huge[] = {-1e300, -1e300};
  TemperedPosterior(log_prior, huge, 1, kNoBias, p);
  EXPECT_DOUBLE_EQ(p[0], 0.5);
  const double one_left[] = {-kInfinity, -5e8};
  TemperedPosterior(log_prior, one_left, 1, kNoBias, p);
  EXPECT_DOUBLE_EQ(p[0], 0);
  EXPECT_DOUBLE_EQ(p[1], 1);
}

TEST(TemperedPosteriorTest, NoScoreLeavesThePrior) {
  const double log_prior[] = {std::log(0.2), std::log(0.8)};
  const double none[] = {-kInfinity, -kInfinity};
  double p[2];
  TemperedPosterior(log_prior, none, 0.5, kNoBias, p);
  EXPECT_NEAR(p[0], 0.2, 1e-15);
}

TEST(TemperedPosteriorTest, ABiasOfLog2DoublesTheOdds) {
  const double log_prior[] = {std::log(0.5), std::log(0.5)};
  const double score[] = {0, -1};
  const double bias[] = {0, std::log(2)};
  double p[2];
  TemperedPosterior(log_prior, score, 1, bias, p);
  EXPECT_NEAR(p[1] / p[0], 2 * std::exp(-1), 1e-15);
}

TEST(BiasAtTest, InterpolatesAsTheOtherTablesDo) {
  Calibration c = testing::SmallModel().calibration;
  c.hmm_bias = {0, 0, 0, 0, 1, 2, 3, 4};
  double bias[4];
  BiasAt(c.hmm_bias, CalibrationAt(c, std::pow(10, 1.5)), bias);
  EXPECT_NEAR(bias[3], 2, 1e-12);
  BiasAt(c.hmm_bias, CalibrationAt(c, 1e9), bias);
  EXPECT_EQ(bias[1], 2);
}

TEST(FusePosteriorsTest, WeightPicksOneAndZeroDoesNotVeto) {
  const double a[] = {0.9, 0.1, 0.0};
  const double b[] = {0.2, 0.3, 0.5};
  const double none[] = {0, 0, 0};
  double fused[3];
  FusePosteriors(a, b, {.hmm_weight = 1, .lstm_weight = 0}, none, fused);
  EXPECT_NEAR(fused[0], 0.9, 1e-12);
  FusePosteriors(a, b, {.hmm_weight = 0, .lstm_weight = 1}, none, fused);
  EXPECT_NEAR(fused[2], 0.5, 1e-12);
  const CalibrationPoint even = {.hmm_weight = 0.5, .lstm_weight = 0.5};
  FusePosteriors(a, b, even, none, fused);
  EXPECT_NEAR(std::accumulate(fused, fused + 3, 0.0), 1, 1e-12);
  EXPECT_NEAR(fused[0] / fused[1], std::sqrt(0.18 / 0.03), 1e-9);
  const double bias[] = {0, std::log(2), 0};
  FusePosteriors(a, b, even, bias, fused);
  EXPECT_NEAR(fused[0] / fused[1], std::sqrt(0.18 / 0.03) / 2, 1e-9);
}

TEST(UnknownProbabilityTest, GrowsAsEvidenceFallsBelowTraining) {
  CalibrationPoint point;
  point.evidence_median = -2;
  point.evidence_deviation = 2;
  EXPECT_LT(UnknownProbability(point, -2, {}), 0.01);
  EXPECT_NEAR(UnknownProbability(point, -14, {}), 0.5, 1e-12);
  EXPECT_GT(UnknownProbability(point, -100, {}), 0.999);
  EXPECT_EQ(UnknownProbability(point, -kInfinity, {}), 1);
}

TEST(UnknownProbabilityTest, GrowsBelowTheStiffnessesOfTraining) {
  Calibration c = testing::SmallModel().calibration;
  const double likely = c.evidence_median[0];
  const double unlikely = likely - 100;
  const auto without = CalibrationAt(c, 1);
  EXPECT_EQ(UnknownProbability(without, likely, -30),
            UnknownProbability(without, likely, {}));
  c.softest = {3, 3};
  const auto point = CalibrationAt(c, 1);
  EXPECT_LT(UnknownProbability(point, likely, 7), 0.01);
  EXPECT_NEAR(UnknownProbability(point, likely, 3), 0.5, 1e-12);
  EXPECT_GT(UnknownProbability(point, likely, 2.7), 0.99);
  // What no class explains is unknown, however stiff it is.
  EXPECT_GT(UnknownProbability(point, unlikely, 7), 0.999);
}

TEST(ValidateCalibrationTest, EachSpoiltTableIsRefused) {
  const Calibration good = testing::SmallModel().calibration;
  EXPECT_TRUE(Validate(good, 4, false).ok());
  using Spoil = void (*)(Calibration&);
  const Spoil spoils[] = {
      [](Calibration& c) { c.frames.clear(); },
      [](Calibration& c) {
        c.frames = {100, 10};
      },
      [](Calibration& c) { c.frames[0] = 0; },
      [](Calibration& c) { c.hmm_inverse_temperature[1] = -1; },
      [](Calibration& c) { c.hmm_inverse_temperature.pop_back(); },
      [](Calibration& c) { c.hmm_bias.pop_back(); },
      [](Calibration& c) { c.hmm_bias[2] = std::nan(""); },
      [](Calibration& c) { c.fused_bias = c.hmm_bias; },
      [](Calibration& c) { c.evidence_deviation[0] = 0; },
      [](Calibration& c) { c.evidence_median[0] = std::nan(""); },
      [](Calibration& c) { c.softest = {3}; },
      [](Calibration& c) {
        c.softest = {3, std::nan("")};
      },
      [](Calibration& c) {
        c.softest = {3, 101};
      },
      [](Calibration& c) { c.prior[0] = 0.5; },
      [](Calibration& c) { c.prior.pop_back(); },
      [](Calibration& c) { c.decision_threshold = 0.5; },
      [](Calibration& c) { c.decision_frames = 0; },
      [](Calibration& c) {
        c.lstm_weight = {0.5, 0.5};
      },
  };
  for (size_t i = 0; i < std::size(spoils); ++i) {
    Calibration c = good;
    spoils[i](c);
    EXPECT_EQ(ReasonOf(Validate(c, 4, false)), "INVALID_MODEL") << i;
  }
}

}  // namespace
}  // namespace tactus::internal
