#include "core/train/calibrate.h"

#include <cmath>

#include "core/base/random.h"
#include "core/classify/calibration.h"
#include "core/eval/metrics.h"
#include "gtest/gtest.h"

namespace tactus {
namespace {

TEST(CalibrationFramesTest, FollowTheSamplingRate) {
  EXPECT_EQ(CalibrationFrames(100),
            (std::vector<double>{10, 25, 50, 120, 250, 500}));
  EXPECT_EQ(CalibrationFrames(2), (std::vector<double>{1, 2, 5, 10}));
}

// Scores drawn so that log-odds s are right with probability sigmoid(s / 20):
// the fitted temperature must come out near 1/20 and calibrated.
TEST(FitCalibrationTest, FindsTheFactorThatMakesScoresHonest) {
  constexpr double kOverconfidence = 20;
  Random random(4);
  std::vector<ScoredContact> contacts;
  for (int i = 0; i < 4000; ++i) {
    const double honest = random.Uniform(-4, 4);
    ScoredContact contact;
    contact.label = random.Uniform() < 1 / (1 + std::exp(-honest)) ? 1 : 0;
    contact.log_likelihood.assign(6,
                                  {-100.0, -100.0 + kOverconfidence * honest});
    contact.hmm_steps = CalibrationFrames(100);
    contacts.push_back(contact);
  }
  Calibration c;
  c.prior = {0.5, 0.5};
  FitCalibration(contacts, 100, c);
  ASSERT_EQ(c.hmm_inverse_temperature.size(), 6u);
  std::vector<Outcome> outcomes;
  const double log_prior[] = {std::log(0.5), std::log(0.5)};
  for (const auto& contact : contacts) {
    Outcome outcome{contact.label, {0, 0}};
    TemperedPosterior(log_prior, contact.log_likelihood[3],
                      c.hmm_inverse_temperature[3], outcome.probability);
    outcomes.push_back(outcome);
  }
  EXPECT_NEAR(c.hmm_inverse_temperature[3] * kOverconfidence, 1, 0.1);
  EXPECT_LT(ExpectedCalibrationError(outcomes), 0.03);
  EXPECT_TRUE(Validate(c, 2, false).ok());
}

// Evidence 0, -1 .. -100 a step: five contacts in a hundred are beyond -95.
TEST(FitCalibrationTest, FewKnownContactsAreCalledUnknown) {
  std::vector<ScoredContact> contacts(101);
  for (int i = 0; i <= 100; ++i) {
    contacts[i].hmm_steps.assign(6, 4);
    contacts[i].log_likelihood.assign(6, {-4.0 * i, -4.0 * i - 7});
    contacts[i].label = i % 2;
  }
  Calibration c;
  c.prior = {0.5, 0.5};
  FitCalibration(contacts, 100, c);
  EXPECT_NEAR(c.evidence_median[0], -50, 1e-12);
  const CalibrationPoint point = CalibrationAt(c, c.frames[0]);
  EXPECT_NEAR(UnknownProbability(point, -95), 0.5, 1e-12);
  EXPECT_LT(UnknownProbability(point, -50), 0.01);
}

}  // namespace
}  // namespace tactus
