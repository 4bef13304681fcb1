#include "core/contacts/question_truth.h"

#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

const std::vector<std::string> kClasses = {"HU", "HM", "SU", "SM"};

LabelledContact Contact(const std::string& label,
                        const std::vector<double>& motion) {
  LabelledContact contact;
  contact.label = label;
  contact.object_motion = motion;
  for (size_t t = 0; t < motion.size(); ++t) {
    contact.frames.push_back_numbers({});
  }
  return contact;
}

TEST(QuestionTruthTest, AStateChangesWhenTheObjectHasMoved) {
  const auto questions = DefaultQuestions(kClasses);
  const LabelledContact contact = Contact("SM", {0, 0.001, 0.0011, 0.02});
  const QuestionTruth mobility(questions[1], kClasses, contact);
  EXPECT_EQ(mobility.at(0), 0);
  EXPECT_EQ(mobility.at(1), 0);
  EXPECT_EQ(mobility.at(2), 1);
  EXPECT_EQ(mobility.final_value(), 1);
  EXPECT_EQ(mobility.change(), 2u);
  const QuestionTruth hardness(questions[0], kClasses, contact);
  EXPECT_EQ(hardness.at(0), 1);
  EXPECT_EQ(hardness.at(3), 1);
  EXPECT_FALSE(hardness.change());
}

// Such a contact counted as one that never changes: its first answer, unmoved,
// was a false alarm.
TEST(QuestionTruthTest, AnObjectCanHaveMovedBeforeItIsFelt) {
  const auto questions = DefaultQuestions(kClasses);
  const LabelledContact contact = Contact("HM", {0.002, 0.01});
  const QuestionTruth mobility(questions[1], kClasses, contact);
  EXPECT_EQ(mobility.at(0), 1);
  EXPECT_EQ(mobility.final_value(), 1);
  EXPECT_EQ(mobility.change(), 0u);
}

TEST(QuestionTruthTest, AContactThatEndsBeforeTheMoveWasUnmoved) {
  const auto questions = DefaultQuestions(kClasses);
  const LabelledContact contact = Contact("HM", {0, 0.0005});
  const QuestionTruth mobility(questions[1], kClasses, contact);
  EXPECT_EQ(mobility.final_value(), 0);
  EXPECT_FALSE(mobility.change());
  EXPECT_TRUE(mobility.history_known());
}

TEST(QuestionTruthTest, WithoutMotionTheLabelIsTheAnswer) {
  const auto questions = DefaultQuestions(kClasses);
  LabelledContact contact = Contact("HM", {0, 0.02});
  contact.object_motion.clear();
  const QuestionTruth mobility(questions[1], kClasses, contact);
  EXPECT_EQ(mobility.at(0), 1);
  EXPECT_FALSE(mobility.history_known());
  EXPECT_TRUE(QuestionTruth(questions[0], kClasses, contact).history_known());
}

}  // namespace
}  // namespace tactus::internal
