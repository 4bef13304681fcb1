#include "core/train/fit_decisions.h"

#include "core/classify/contact_classifier.h"
#include "core/train/fit.h"
#include "gtest/gtest.h"
#include "tests/core/eval/synthetic_contacts.h"

namespace tactus::internal {
namespace {

constexpr size_t kThresholds = kTriedThresholds.size();

// Contacts of one question: at threshold t, `held[t]` of `made[t]` decisions
// hold.
std::vector<TriedDecisions> Tried(const std::vector<int>& made,
                                  const std::vector<int>& held) {
  std::vector<TriedDecisions> contacts(1000, TriedDecisions(1));
  for (size_t t = 0; t < kThresholds; ++t) {
    for (int i = 0; i < made[t]; ++i) contacts[i][0][t] = i < held[t];
  }
  return contacts;
}

double Fitted(const std::vector<int>& made, const std::vector<int>& held) {
  Calibration calibration;
  calibration.decision_frames = 7;
  FitDecisions(Tried(made, held), calibration);
  EXPECT_EQ(calibration.question_frames, std::vector<uint32_t>{7});
  EXPECT_EQ(calibration.question_threshold.size(), 1u);
  return calibration.question_threshold[0];
}

TEST(FitDecisionsTest, TheLoosestThresholdWhoseDecisionsHold) {
  // The 95 % interval of 965 of 1,000 begins at 0.9517, that of 963 at 0.9495.
  const std::vector<int> made(kThresholds, 1000);
  EXPECT_EQ(Fitted(made, std::vector<int>(kThresholds, 965)), 0.95);
  std::vector<int> held(kThresholds, 965);
  held[0] = held[1] = 963;
  EXPECT_EQ(Fitted(made, held), 0.97);
  // Behind the first that fails, a pass is luck.
  held[4] = 963;
  EXPECT_EQ(Fitted(made, held), 0.985);
}

TEST(FitDecisionsTest, WithoutEvidenceTheStrictest) {
  const std::vector<int> made(kThresholds, 1000);
  EXPECT_EQ(Fitted(made, std::vector<int>(kThresholds, 940)), 0.999);
  // The 95 % interval of 72 of 72 begins at 0.9493, that of 73 of 73 at 0.95.
  const std::vector<int> few(kThresholds, 72);
  EXPECT_EQ(Fitted(few, few), 0.999);
  const std::vector<int> enough(kThresholds, 73);
  EXPECT_EQ(Fitted(enough, enough), 0.95);
}

TEST(FitDecisionsTest, ThresholdsThatFewReachArePassedOver) {
  std::vector<int> made(kThresholds, 1000);
  made[11] = made[10] = 72;
  std::vector<int> held(kThresholds, 970);
  held[11] = held[10] = 60;
  EXPECT_EQ(Fitted(made, held), 0.95);
}

FitOptions FewStates() {
  FitOptions options;
  options.states = 3;
  options.max_iterations = 4;
  return options;
}

// One classifier per threshold, which decides with it.
TEST(TryDecisionsTest, AreThoseOfClassifiersWithTheseThresholds) {
  auto contacts = testing::SyntheticContacts(6, 60, 0.4, 5);
  for (LabelledContact& contact : contacts) {
    for (size_t t = 0; t < contact.frames.size(); ++t) {
      const bool moves = contact.label[1] == 'M';
      contact.object_motion.push_back(moves && t > 25 ? 0.01 : 0);
    }
  }
  const auto fitted =
      FitModel(testing::PointersTo(contacts), FewStates(), RunSerially);
  ASSERT_TRUE(fitted.ok()) << fitted.status();
  const auto model = *CompiledModel::Create(*fitted);
  int made = 0;
  int held = 0;
  for (const LabelledContact& contact : contacts) {
    const TriedDecisions tried = TryDecisions(model, contact);
    ASSERT_EQ(tried.size(), 2u);
    for (size_t t = 0; t < kThresholds; ++t) {
      ContactClassifier classifier(model,
                                   {.decision_threshold = kTriedThresholds[t]});
      std::optional<bool> want[2];
      for (size_t frame = 0; frame < contact.frames.size(); ++frame) {
        classifier.StepOrHold(contact.frames[frame], 0);
        for (int q = 0; q < 2; ++q) {
          const QuestionDecision& decision = classifier.decisions()[q];
          if (decision.frame != frame + 1) continue;
          const bool second = q == 0 ? contact.label[0] == 'S'
                                     : contact.object_motion[frame] > 0.001;
          want[q] = decision.value == (second ? 1 : 0);
        }
      }
      for (int q = 0; q < 2; ++q) {
        EXPECT_EQ(tried[q][t], want[q]);
        made += want[q].has_value();
        held += want[q].value_or(false);
      }
    }
  }
  EXPECT_GT(held, 0);
  EXPECT_LT(held, made);
}

TEST(FitDecisionsTest, QuestionsAreThoseOfTheLabelTable) {
  const auto contacts = testing::SyntheticContacts(8, 40, 0.1, 2);
  FitOptions options = FewStates();
  const auto plain =
      FitModel(testing::PointersTo(contacts), options, RunSerially);
  ASSERT_TRUE(plain.ok()) << plain.status();
  ASSERT_EQ(plain->questions.size(), 2u);
  EXPECT_EQ(plain->questions[0].name, "hardness");
  // 32 contacts can show nothing of a fraction of 0.95.
  EXPECT_EQ(plain->calibration.question_threshold,
            (std::vector<double>{0.999, 0.999}));
  options.questions = *ParseQuestionTable(
      "class,loose\nHU,no\nHM,yes\nSU,no\nSM,yes\nother,maybe\n");
  const auto asked =
      FitModel(testing::PointersTo(contacts), options, RunSerially);
  ASSERT_TRUE(asked.ok()) << asked.status();
  ASSERT_EQ(asked->questions.size(), 1u);
  EXPECT_EQ(asked->questions[0].values,
            (std::vector<std::string>{"no", "yes"}));
  EXPECT_EQ(asked->warm_up.probability, plain->warm_up.probability);
  options.questions = *ParseQuestionTable("class,loose\nHU,no\nHM,yes\n");
  EXPECT_FALSE(
      FitModel(testing::PointersTo(contacts), options, RunSerially).ok());
}

}  // namespace
}  // namespace tactus::internal
