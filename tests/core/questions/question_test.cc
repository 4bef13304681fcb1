#include "core/questions/question.h"

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(DefaultQuestionsTest, FourClassesAnswerHardnessAndMobility) {
  const auto questions = DefaultQuestions({"HU", "HM", "SU", "SM"});
  ASSERT_EQ(questions.size(), 2u);
  EXPECT_EQ(questions[0].name, "hardness");
  EXPECT_EQ(questions[0].kind, Question::kProperty);
  EXPECT_THAT(questions[0].values, ElementsAre("hard", "soft"));
  EXPECT_THAT(questions[0].value_of_class, ElementsAre(0, 0, 1, 1));
  EXPECT_EQ(questions[1].name, "mobility");
  EXPECT_EQ(questions[1].kind, Question::kState);
  EXPECT_THAT(questions[1].values, ElementsAre("unmoved", "moved"));
  EXPECT_THAT(questions[1].value_of_class, ElementsAre(0, 1, 0, 1));
  EXPECT_TRUE(Validate(questions, 4).ok());
}

TEST(DefaultQuestionsTest, WhatAllClassesAnswerAlikeIsNotAsked) {
  const auto mobility = DefaultQuestions({"SM", "SU"});
  ASSERT_EQ(mobility.size(), 1u);
  EXPECT_EQ(mobility[0].name, "mobility");
  EXPECT_THAT(mobility[0].value_of_class, ElementsAre(1, 0));
  const auto hardness = DefaultQuestions({"HM", "SM"});
  ASSERT_EQ(hardness.size(), 1u);
  EXPECT_EQ(hardness[0].name, "hardness");
  EXPECT_EQ(DefaultQuestions({"HM", "SU"}).size(), 2u);
}

TEST(DefaultQuestionsTest, OtherClassesAreTheirOwnAnswer) {
  for (const std::vector<std::string>& classes :
       std::vector<std::vector<std::string>>{
           {"foil", "wood", "HU"}, {"HX", "HU"}, {"UH", "US"}, {"H", "S"}}) {
    const auto questions = DefaultQuestions(classes);
    ASSERT_EQ(questions.size(), 1u);
    EXPECT_EQ(questions[0].name, "class");
    EXPECT_EQ(questions[0].kind, Question::kProperty);
    EXPECT_EQ(questions[0].values, classes);
    EXPECT_TRUE(Validate(questions, classes.size()).ok());
  }
}

TEST(ValidateQuestionsTest, NamesWhatIsWrong) {
  const auto good = DefaultQuestions({"HU", "HM", "SU", "SM"});
  const auto refused = [&](auto change, const char* text) {
    auto questions = good;
    change(questions);
    const absl::Status status = Validate(questions, 4);
    EXPECT_EQ(ReasonOf(status), "INVALID_MODEL") << text;
    EXPECT_THAT(std::string(status.message()), HasSubstr(text));
  };
  using Questions = std::vector<Question>;
  refused([](Questions& q) { q.clear(); }, "number of questions is 0");
  refused([](Questions& q) { q.resize(9, q[0]); }, "number of questions is 9");
  refused([](Questions& q) { q[1].name = "hardness"; }, "unique");
  refused([](Questions& q) { q[0].name = ""; }, "1 to 64 bytes");
  refused([](Questions& q) { q[0].name = std::string(65, 'a'); },
          "1 to 64 bytes");
  refused([](Questions& q) { q[0].name = "a:state"; }, "without a colon");
  refused([](Questions& q) { q[0].name = "\x1b[31m"; }, "control characters");
  refused([](Questions& q) { q[0].values = {"hard"}; }, "number of values");
  refused([](Questions& q) { q[0].values[1] = "hard"; }, "unique");
  refused([](Questions& q) { q[0].values.push_back("liquid"); },
          "the answer of at least one class");
  refused([](Questions& q) { q[0].value_of_class.pop_back(); },
          "4, one per class");
  refused([](Questions& q) { q[0].value_of_class[0] = -1; }, "below 2");
  refused([](Questions& q) { q[0].value_of_class[0] = 2; }, "below 2");
}

TEST(ValueProbabilityTest, SumsTheClassesOfEachValue) {
  const Question question = {
      "finish", Question::kProperty, {"smooth", "rough", "wet"}, {2, 0, 1, 0}};
  const double posterior[] = {0.125, 0.25, 0.5, 0.125};
  double value[] = {7, 7, 7};
  ValueProbability(question, posterior, value);
  EXPECT_THAT(value, ElementsAre(0.375, 0.5, 0.125));
}

}  // namespace
}  // namespace tactus::internal
