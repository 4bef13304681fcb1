#include "core/train/calibrate.h"

#include <cmath>

#include "core/base/random.h"
#include "core/classify/calibration.h"
#include "core/eval/metrics.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

constexpr double kNoBias[2] = {0, 0};

TEST(CalibrationFramesTest, FollowTheSamplingRate) {
  EXPECT_EQ(CalibrationFrames(100),
            (std::vector<double>{10, 25, 50, 120, 250, 500}));
  EXPECT_EQ(CalibrationFrames(2), (std::vector<double>{1, 2, 5, 10}));
  // Up to the end of a long contact.
  EXPECT_EQ(CalibrationFrames(2, {}, 10), (std::vector<double>{1, 2, 5, 10}));
  EXPECT_EQ(CalibrationFrames(2, {}, 21),
            (std::vector<double>{1, 2, 5, 10, 20, 40}));
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
    const int label = random.Uniform() < 1 / (1 + std::exp(-honest)) ? 1 : 0;
    contact.labels.assign(6, label);
    contact.log_likelihood.assign(6,
                                  {-100.0, -100.0 + kOverconfidence * honest});
    contact.hmm_steps = CalibrationFrames(100);
    contacts.push_back(contact);
  }
  Calibration c;
  c.prior = {0.5, 0.5};
  FitCalibration(contacts, CalibrationFrames(100), c);
  ASSERT_EQ(c.hmm_inverse_temperature.size(), 6u);
  std::vector<Outcome> outcomes;
  const double log_prior[] = {std::log(0.5), std::log(0.5)};
  for (const auto& contact : contacts) {
    Outcome outcome{contact.labels[3], {0, 0}};
    TemperedPosterior(log_prior, contact.log_likelihood[3],
                      c.hmm_inverse_temperature[3], kNoBias,
                      outcome.probability);
    outcomes.push_back(outcome);
  }
  EXPECT_NEAR(c.hmm_inverse_temperature[3] * kOverconfidence, 1, 0.1);
  EXPECT_LT(ExpectedCalibrationError(outcomes), 0.03);
  EXPECT_TRUE(Validate(c, 2, false).ok());
}

// Two sensors of one quantity. What the HMMs and the LSTMs say about a label is
// drawn independently, or the LSTMs say nothing. `share` of the labels are 1.
std::vector<ScoredContact> TwoSensors(double lstm_strength, Random& random,
                                      double share = 0.5) {
  std::vector<ScoredContact> contacts;
  for (int i = 0; i < 4000; ++i) {
    const int label = random.Uniform() < share ? 1 : 0;
    const double sign = label == 1 ? 1 : -1;
    // A Gaussian at +-1 with deviation 1 has the log-odds 2 x.
    const double hmm = 2 * (sign + random.Gaussian());
    const double x = lstm_strength * sign + random.Gaussian();
    const double odds = 2 * lstm_strength * x;
    ScoredContact contact;
    contact.labels.assign(6, label);
    contact.log_likelihood.assign(6, {0.0, hmm});
    contact.lstm_score.assign(
        6, {-std::log1p(std::exp(odds)), -std::log1p(std::exp(-odds))});
    contact.hmm_steps = CalibrationFrames(100);
    contacts.push_back(contact);
  }
  return contacts;
}

// The log-odds of independent sensors add up: both weights are 1.
TEST(FitCalibrationTest, TwoSensorsAreFusedByBayesRule) {
  Random random(7);
  Calibration c;
  c.prior = {0.5, 0.5};
  FitCalibration(TwoSensors(1, random), CalibrationFrames(100), c);
  for (int time = 0; time < 6; ++time) {
    EXPECT_NEAR(c.hmm_weight[time] * c.hmm_inverse_temperature[time], 1, 0.1);
    EXPECT_NEAR(c.lstm_weight[time] * c.lstm_inverse_temperature[time], 1, 0.1);
  }
  EXPECT_TRUE(Validate(c, 2, true).ok());
}

TEST(FitCalibrationTest, AModelThatSaysNothingGetsNoWeight) {
  Random random(8);
  Calibration c;
  c.prior = {0.5, 0.5};
  FitCalibration(TwoSensors(0, random), CalibrationFrames(100), c);
  EXPECT_EQ(c.hmm_weight, std::vector<double>(6, 1));
  EXPECT_EQ(c.lstm_weight, std::vector<double>(6, 0));
  EXPECT_EQ(c.fused_bias, std::vector<double>(12, 0));
}

// Log-odds of the fused answer to scores that say `hmm` and `lstm`.
double FusedLogOdds(const Calibration& c, double hmm, double lstm) {
  const CalibrationPoint point = CalibrationAt(c, c.frames[2]);
  const double log_prior[] = {std::log(0.5), std::log(0.5)};
  double bias[2];
  double of_hmm[2];
  double of_lstm[2];
  double fused[2];
  BiasAt(c.hmm_bias, point, bias);
  TemperedPosterior(log_prior, std::vector{0.0, hmm},
                    point.hmm_inverse_temperature, bias, of_hmm);
  BiasAt(c.lstm_bias, point, bias);
  TemperedPosterior(
      log_prior,
      std::vector{-std::log1p(std::exp(lstm)), -std::log1p(std::exp(-lstm))},
      point.lstm_inverse_temperature, bias, of_lstm);
  BiasAt(c.fused_bias, point, bias);
  FusePosteriors(of_hmm, of_lstm, point, bias, fused);
  return std::log(fused[1] / fused[0]);
}

// Contacts whose scores are right at `right_times` of six times.
std::vector<ScoredContact> RightAt(const std::vector<std::vector<int>>& times) {
  std::vector<ScoredContact> contacts;
  for (size_t i = 0; i < times.size(); ++i) {
    ScoredContact& contact = contacts.emplace_back();
    const int label = static_cast<int>(i % 2);
    contact.labels.assign(6, label);
    contact.hmm_steps.assign(6, 1);
    contact.bounded = true;
    for (int t = 0; t < 6; ++t) {
      const bool right = std::ranges::count(times[i], t) > 0;
      const bool one = (label == 1) == right;
      contact.log_likelihood.push_back({one ? 0.0 : 1.0, one ? 1.0 : 0.0});
    }
  }
  return contacts;
}

uint32_t HeldAfter(const std::vector<std::vector<int>>& times) {
  const auto contacts = RightAt(times);
  Calibration c;
  c.prior = {0.5, 0.5};
  FitCalibration(contacts, CalibrationFrames(100), c);
  EXPECT_EQ(c.hold_after_frames, 0u);
  HoldTheBestAnswer(contacts, c);
  EXPECT_TRUE(Validate(c, 2, false).ok());
  return c.hold_after_frames;
}

TEST(HoldTheBestAnswerTest, HoldsWhatLaterFramesWouldSpoil) {
  const std::vector<int> always = {0, 1, 2, 3, 4, 5};
  EXPECT_EQ(HeldAfter({always, always, always, always}), 0u);
  EXPECT_EQ(HeldAfter({always, always, always, {3, 4, 5}}), 0u);
  // The last of equal times: 10, 25, 50, 120, 250 and 500 frames.
  EXPECT_EQ(HeldAfter({always, always, always, {2, 3}}), 120u);
  EXPECT_EQ(HeldAfter({always, always, always, {2, 3}, {4}, always}), 250u);
}

// By Bayes' rule the log-odds of the shares are added to those of the sensors.
TEST(PresumeEvenSharesTest, TakesAwayTheLogOddsOfTheShares) {
  constexpr double kShare = 0.9;
  Random random(9);
  const auto contacts = TwoSensors(1, random, kShare);
  Calibration c;
  c.prior = {0.5, 0.5};
  FitCalibration(contacts, CalibrationFrames(100), c);
  const double odds = std::log(kShare / (1 - kShare));
  EXPECT_NEAR(FusedLogOdds(c, 0, 0), odds, 0.2);
  EXPECT_NEAR(FusedLogOdds(c, 1, -2), odds - 1, 0.3);
  PresumeEvenShares(contacts, c);
  EXPECT_NEAR(FusedLogOdds(c, 0, 0), 0, 0.2);
  EXPECT_NEAR(FusedLogOdds(c, 1, -2), -1, 0.3);
  EXPECT_TRUE(Validate(c, 2, true).ok());
}

// Evidence 0, -1 .. -100 a step: five contacts in a hundred are beyond -95.
TEST(FitCalibrationTest, FewKnownContactsAreCalledUnknown) {
  std::vector<ScoredContact> contacts(101);
  for (int i = 0; i <= 100; ++i) {
    contacts[i].hmm_steps.assign(6, 4);
    contacts[i].log_likelihood.assign(6, {-4.0 * i, -4.0 * i - 7});
    contacts[i].labels.assign(6, i % 2);
  }
  Calibration c;
  c.prior = {0.5, 0.5};
  FitCalibration(contacts, CalibrationFrames(100), c);
  EXPECT_NEAR(c.evidence_median[0], -50, 1e-12);
  const CalibrationPoint point = CalibrationAt(c, c.frames[0]);
  EXPECT_NEAR(UnknownProbability(point, -95, {}), 0.5, 1e-12);
  EXPECT_LT(UnknownProbability(point, -50, {}), 0.01);
  EXPECT_TRUE(c.softest.empty());
}

// Evidence and stiffness that have nothing to do with each other. The stiffness
// is one of two: few objects lie between soft and hard.
std::vector<ScoredContact> SoftAndHard(int count) {
  Random random(10);
  std::vector<ScoredContact> contacts(count);
  for (ScoredContact& contact : contacts) {
    const bool hard = random.Index(2) == 1;
    contact.labels.assign(6, hard ? 1 : 0);
    contact.hmm_steps.assign(6, 1);
    contact.log_likelihood.assign(6, {random.Gaussian(), -10});
    const double stiffness = (hard ? 8 : 3.5) + 0.2 * random.Gaussian();
    contact.log10_stiffness.assign(6, stiffness);
  }
  return contacts;
}

double CalledUnknown(const std::vector<ScoredContact>& contacts,
                     const Calibration& c, size_t time) {
  const CalibrationPoint point = CalibrationAt(c, c.frames[time]);
  double called = 0;
  for (const ScoredContact& contact : contacts) {
    called += UnknownProbability(point, contact.log_likelihood[time][0],
                                 contact.log10_stiffness[time]) > 0.5;
  }
  return called / static_cast<double>(contacts.size());
}

TEST(FitCalibrationTest, AnObjectSofterThanKnownOnesIsUnknown) {
  const auto contacts = SoftAndHard(4000);
  Calibration c;
  c.prior = {0.5, 0.5};
  FitCalibration(contacts, CalibrationFrames(100), c);
  ASSERT_TRUE(Validate(c, 2, false).ok());
  ASSERT_EQ(c.softest.size(), 6u);
  // Both reasons together give as many false alarms as one did.
  EXPECT_NEAR(CalledUnknown(contacts, c, 3), 0.05, 0.003);
  const CalibrationPoint point = CalibrationAt(c, c.frames[3]);
  EXPECT_LT(UnknownProbability(point, 0, 3.5), 0.01);
  EXPECT_GT(UnknownProbability(point, 0, 2.8), 0.9);
}

TEST(FitCalibrationTest, ObjectsOfOneStiffnessAreKnownDownToHalf) {
  auto contacts = SoftAndHard(400);
  for (ScoredContact& contact : contacts) contact.log10_stiffness.assign(6, 5);
  Calibration c;
  c.prior = {0.5, 0.5};
  FitCalibration(contacts, CalibrationFrames(100), c);
  ASSERT_TRUE(Validate(c, 2, false).ok());
  const CalibrationPoint point = CalibrationAt(c, c.frames[3]);
  EXPECT_LT(UnknownProbability(point, 0, 4.75), 0.5);
  EXPECT_GT(UnknownProbability(point, 0, 4.65), 0.5);
}

// Contacts that end before the first estimate have none.
TEST(FitCalibrationTest, TooFewEstimatesSayNothingOfTheStiffness) {
  auto contacts = SoftAndHard(400);
  for (size_t i = 39; i < contacts.size(); ++i) {
    contacts[i].log10_stiffness[0] = std::nan("");
  }
  Calibration c;
  c.prior = {0.5, 0.5};
  FitCalibration(contacts, CalibrationFrames(100), c);
  EXPECT_TRUE(c.softest.empty());
  EXPECT_TRUE(Validate(c, 2, false).ok());
  contacts[39].log10_stiffness[0] = 8;
  FitCalibration(contacts, CalibrationFrames(100), c);
  EXPECT_EQ(c.softest.size(), 6u);
}

}  // namespace
}  // namespace tactus::internal
