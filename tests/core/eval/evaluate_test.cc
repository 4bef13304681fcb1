#include "core/eval/evaluate.h"

#include "core/base/errors.h"
#include "core/classify/contact_classifier.h"
#include "gtest/gtest.h"
#include "tests/core/eval/synthetic_contacts.h"

namespace tactus::internal {
namespace {

FitOptions QuickOptions() {
  FitOptions options;
  options.states = 3;
  options.max_iterations = 4;
  return options;
}

TEST(EvaluateProtocolTest, DistinguishesSeparateClasses) {
  const auto contacts = testing::SyntheticContacts(10, 60, 0.02, 1);
  for (const char* algorithm : {"hmm", "fused", "1nn"}) {
    auto result = EvaluateProtocol(
        testing::PointersTo(contacts), Protocol::kLeaveOneMaterialOut,
        *ParseAlgorithm(algorithm), QuickOptions(), RunSerially);
    ASSERT_TRUE(result.ok()) << algorithm << ": " << result.status();
    EXPECT_EQ(result->final.size(), 40u);
    EXPECT_GE(Accuracy(result->final), 0.95) << algorithm;
    ASSERT_EQ(result->anytime.size(), static_cast<size_t>(kAnytimeCount));
    for (const auto& outcomes : result->anytime) {
      for (const Outcome& outcome : outcomes) {
        ASSERT_EQ(outcome.probability.size(), 4u);
      }
    }
  }
}

// Labels that mean nothing: no protocol may beat chance by much, which is what
// peeking into the test folds would do.
TEST(EvaluateProtocolTest, RandomLabelsStayAtChance) {
  auto contacts = testing::SyntheticContacts(30, 30, 0.5, 1);
  Random random(9);
  const char* labels[] = {"HU", "HM", "SU", "SM"};
  for (auto& contact : contacts) contact.label = labels[random.Index(4)];
  for (const char* algorithm : {"hmm", "1nn"}) {
    auto result = EvaluateProtocol(testing::PointersTo(contacts),
                                   Protocol::kKFold, *ParseAlgorithm(algorithm),
                                   QuickOptions(), RunSerially);
    ASSERT_TRUE(result.ok()) << result.status();
    EXPECT_LT(Accuracy(result->final), 0.40) << algorithm;
  }
}

// A classifier of its own, stepped in a plain loop.
TEST(EvaluateModelTest, QuestionsAreWatchedAtEveryFrame) {
  auto contacts = testing::SyntheticContacts(6, 60, 0.4, 7);
  for (LabelledContact& contact : contacts) {
    for (size_t t = 0; t < contact.frames.size(); ++t) {
      const bool moves = contact.label[1] == 'M';
      contact.object_motion.push_back(moves && t > 20 ? 0.01 : 0);
    }
  }
  const auto pointers = testing::PointersTo(contacts);
  auto fitted = FitModel(pointers, QuickOptions(), RunSerially);
  ASSERT_TRUE(fitted.ok()) << fitted.status();
  fitted->calibration.question_threshold = {0.8, 0.9};
  fitted->calibration.question_frames = {3, 2};
  const auto model = *CompiledModel::Create(*fitted);
  const auto result =
      EvaluateModel(model, pointers, Algorithm::kHmm, RunSerially);
  ASSERT_TRUE(result.ok()) << result.status();
  ASSERT_EQ(result->questions.size(), 2u);
  int decided = 0;
  for (size_t i = 0; i < contacts.size(); ++i) {
    const LabelledContact& contact = contacts[i];
    ContactClassifier classifier(model, {});
    const int soft = contact.label[0] == 'S';
    const bool moves = contact.label[1] == 'M';
    int run = 0;
    std::optional<double> decision_s;
    std::optional<double> soft_s;
    std::optional<double> moved_s;
    bool false_alarm = false;
    for (size_t t = 0; t < contact.frames.size(); ++t) {
      classifier.Step(contact.frames[t].sample, 0);
      const auto p = classifier.probability();
      const double right = soft ? p[2] + p[3] : p[0] + p[1];
      const double moved = p[1] + p[3];
      const double time = static_cast<double>(t) / 100;
      if (!soft_s && right > 0.9) soft_s = time;
      if (moves && t > 20 && !moved_s && moved > 0.9) moved_s = time - 0.21;
      false_alarm |= !moves && moved > 0.9;
      run = right >= 0.8 && classifier.unknown() < 0.5 ? run + 1 : 0;
      if (run == 3 && !decision_s) decision_s = time + 0.01;
    }
    const QuestionOutcome& hardness = result->question_outcomes[0][i];
    const QuestionOutcome& mobility = result->question_outcomes[1][i];
    EXPECT_EQ(hardness.timing.delay_s, soft_s);
    EXPECT_EQ(hardness.final.label, soft);
    EXPECT_EQ(hardness.anytime.size(), static_cast<size_t>(kAnytimeCount));
    EXPECT_EQ(mobility.timing.from_s.has_value(), moves);
    ASSERT_EQ(mobility.timing.delay_s.has_value(), moved_s.has_value());
    if (moved_s) {
      EXPECT_NEAR(*mobility.timing.delay_s, *moved_s, 1e-12);
    }
    EXPECT_EQ(mobility.timing.false_alarm.value_or(false), false_alarm);
    EXPECT_EQ(mobility.anytime[0].label, 0);
    EXPECT_EQ(mobility.final.label, moves ? 1 : 0);
    if (!hardness.decision || hardness.decision->value != soft) continue;
    ++decided;
    EXPECT_EQ(hardness.decision->truth, soft);
    if (hardness.changes == 0) {
      EXPECT_DOUBLE_EQ(hardness.decision->seconds, decision_s.value_or(-1));
    }
  }
  EXPECT_GT(decided, 10);
}

TEST(EvaluateModelTest, RefusesWhatTheModelCannotAnswer) {
  const auto contacts = testing::SyntheticContacts(4, 20, 0.1, 1);
  const auto pointers = testing::PointersTo(contacts);
  auto model = FitModel(pointers, QuickOptions(), RunSerially);
  ASSERT_TRUE(model.ok());
  auto compiled = *CompiledModel::Create(*model);
  for (auto algorithm : {Algorithm::kNearest, Algorithm::kLstm}) {
    EXPECT_EQ(
        ReasonOf(
            EvaluateModel(compiled, pointers, algorithm, RunSerially).status()),
        "INVALID_CONFIG");
  }
  auto other = contacts;
  other[0].label = "cork";
  EXPECT_EQ(ReasonOf(EvaluateModel(compiled, testing::PointersTo(other),
                                   Algorithm::kHmm, RunSerially)
                         .status()),
            "INVALID_CONFIG");
  auto result = EvaluateModel(compiled, pointers, Algorithm::kHmm, RunSerially);
  ASSERT_TRUE(result.ok());
  EXPECT_GE(Accuracy(result->final), 0.9);
  model->inputs.hmm.front().cue = NamedCue("row_load_0");
  compiled = *CompiledModel::Create(*model);
  EXPECT_EQ(
      ReasonOf(EvaluateModel(compiled, pointers, Algorithm::kHmm, RunSerially)
                   .status()),
      "INVALID_CONFIG");
}

}  // namespace
}  // namespace tactus::internal
