// Training data at the edge of what can be fitted: classes that are perfectly
// separable, signals without any noise, contacts without any information,
// contacts of two frames. A fit is refused with a reason, or its model is valid
// and its answers are probabilities.
#include <cmath>
#include <numeric>

#include "core/base/errors.h"
#include "core/classify/calibration.h"
#include "core/classify/contact_classifier.h"
#include "core/train/calibrate.h"
#include "core/train/fit.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/eval/synthetic_contacts.h"

namespace tactus::internal {
namespace {

using ::testing::HasSubstr;

FitOptions SmallFit() {
  FitOptions options = *FitPreset("tuned");
  options.states = 2;
  options.hmms_per_class = 2;
  options.max_iterations = 4;
  options.lstm.cells = {5};
  options.lstm.training.epochs = 2;
  return options;
}

// Fits a model and classifies its own contacts.
void ExpectSoundFit(const std::vector<LabelledContact>& contacts,
                    const FitOptions& options) {
  auto model = FitModel(testing::PointersTo(contacts), options, RunSerially);
  ASSERT_TRUE(model.ok()) << model.status();
  auto compiled = CompiledModel::Create(*std::move(model));
  ASSERT_TRUE(compiled.ok()) << compiled.status();
  ASSERT_TRUE(RunWarmUp(**compiled).ok());
  for (const LabelledContact& contact : contacts) {
    ContactClassifier classifier(*compiled, {});
    for (const ContactFrame& frame : contact.frames) {
      classifier.StepOrHold(frame, 0);
      const auto p = classifier.probability();
      for (const double value : p) ASSERT_TRUE(value >= 0) << contact.id;
      ASSERT_NEAR(std::accumulate(p.begin(), p.end(), 0.0), 1, 1e-9);
      ASSERT_TRUE(classifier.unknown() >= 0 && classifier.unknown() <= 1);
    }
  }
}

// Each class at a level, constant from the first frame on.
std::vector<LabelledContact> ConstantContacts(double step, int frames) {
  std::vector<LabelledContact> contacts;
  const char* const labels[] = {"HU", "HM", "SU", "SM"};
  for (int i = 0; i < 32; ++i) {
    LabelledContact& contact = contacts.emplace_back();
    contact.id = std::to_string(i);
    contact.label = labels[i % 4];
    contact.condition = i < 16 ? "slow" : "fast";
    for (int t = 0; t < frames; ++t) {
      contact.frames.push_back({IdealSample(
          {1 + step * (i % 4), 1e-4, 0.01 * (1 + step * (i % 4))})});
    }
  }
  return contacts;
}

TEST(HardDataTest, CalibrationOfSeparableScoresIsFinite) {
  constexpr int kClasses = 3;
  // By any margin, from a rounding error to the largest that HMMs reach.
  for (const double margin : {1e-12, 1.0, 1e3, 1e12}) {
    std::vector<ScoredContact> contacts;
    for (int i = 0; i < 60; ++i) {
      ScoredContact& contact = contacts.emplace_back();
      const int label = i % kClasses;
      contact.labels.assign(6, label);
      std::vector<double> scores(kClasses, -margin);
      scores[label] = 0;
      contact.log_likelihood.assign(6, scores);
      for (double& score : scores) score = std::max(score, -700.0);
      contact.lstm_score.assign(6, scores);
      contact.hmm_steps = CalibrationFrames(100);
    }
    Calibration c;
    c.prior.assign(kClasses, 1.0 / kClasses);
    FitCalibration(contacts, CalibrationFrames(100), c);
    const absl::Status valid = Validate(c, kClasses, /*has_lstm=*/true);
    EXPECT_TRUE(valid.ok()) << margin << ": " << valid;
    const CalibrationPoint point = CalibrationAt(c, 50);
    const std::vector<double> log_prior(kClasses, -std::log(kClasses));
    std::vector<double> bias(kClasses), p(kClasses);
    BiasAt(c.hmm_bias, point, bias);
    TemperedPosterior(log_prior, contacts[0].log_likelihood[2],
                      point.hmm_inverse_temperature, bias, p);
    EXPECT_NEAR(std::accumulate(p.begin(), p.end(), 0.0), 1, 1e-9);
    EXPECT_GT(p[0], margin >= 1e3 ? 0.9 : 0.3);
  }
}

TEST(HardDataTest, ConstantSignalsAreFittedOrRefused) {
  ExpectSoundFit(ConstantContacts(0.5, 40), SmallFit());
}

TEST(HardDataTest, ContactsThatAreAllTheSameGiveNoAnswer) {
  ExpectSoundFit(ConstantContacts(0, 40), SmallFit());
}

TEST(HardDataTest, ContactsOfTwoFrames) {
  const auto contacts = testing::SyntheticContacts(8, 2, 0.1, 1);
  // The preset's models step after five frames.
  const auto refused =
      FitModel(testing::PointersTo(contacts), SmallFit(), RunSerially);
  EXPECT_EQ(ReasonOf(refused.status()), "INVALID_TRAINING_DATA");
  EXPECT_THAT(refused.status().message(), HasSubstr("32 of 32"));
  FitOptions options = SmallFit();
  options.hmm_steps = options.lstm.steps = {1, 1};
  ExpectSoundFit(contacts, options);
}

TEST(HardDataTest, OneClassIsRefused) {
  auto contacts = ConstantContacts(0.5, 40);
  for (LabelledContact& contact : contacts) contact.label = "HU";
  const auto refused =
      FitModel(testing::PointersTo(contacts), SmallFit(), RunSerially);
  EXPECT_EQ(ReasonOf(refused.status()), "INVALID_TRAINING_DATA");
  EXPECT_THAT(refused.status().message(), HasSubstr("class"));
}

}  // namespace
}  // namespace tactus::internal
