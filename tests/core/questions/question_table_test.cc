#include "core/questions/question_table.h"

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr char kFour[] =
    "class,hardness,mobility\n"
    "HU,hard,unmoved\n"
    "HM,hard,moved\n"
    "SU,soft,unmoved\n"
    "SM,soft,moved\n";

void ExpectSame(const Question& a, const Question& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.values, b.values);
  EXPECT_EQ(a.value_of_class, b.value_of_class);
}

TEST(QuestionTableTest, TheFourClassesAreTheDefault) {
  const auto table = ParseQuestionTable(kFour);
  ASSERT_TRUE(table.ok()) << table.status();
  // In another order than the table's.
  const std::vector<std::string> classes = {"SM", "HU", "SU", "HM"};
  const auto questions = QuestionsFor(*table, classes);
  ASSERT_TRUE(questions.ok()) << questions.status();
  const auto want = DefaultQuestions(classes);
  ASSERT_EQ(questions->size(), 2u);
  ExpectSame((*questions)[0], want[0]);
  ExpectSame((*questions)[1], want[1]);
}

TEST(QuestionTableTest, KindsQuotesAndLineEndsOfSpreadsheets) {
  const auto table = ParseQuestionTable(
      "\xEF\xBB\xBF"
      "class,mobility:property,\"grip, now\":state\r\n"
      "\r\n"
      "\"foil, \"\"thin\"\"\", fixed ,firm\r\n"
      "wood,free,\"none\"\r\n");
  // Quotes enclose whole cells.
  EXPECT_FALSE(table.ok());
  const auto quoted = ParseQuestionTable(
      "\xEF\xBB\xBF"
      "class,mobility:property,\"grip, now:state\"\r\n"
      "\r\n"
      "\"foil, \"\"thin\"\"\", fixed ,firm\r\n"
      "wood,free,\"none\"\r\n");
  ASSERT_TRUE(quoted.ok()) << quoted.status();
  EXPECT_THAT(quoted->class_names, ElementsAre("foil, \"thin\"", "wood"));
  EXPECT_EQ(quoted->questions[0].kind, Question::kProperty);
  EXPECT_EQ(quoted->questions[1].name, "grip, now");
  EXPECT_EQ(quoted->questions[1].kind, Question::kState);
  EXPECT_THAT(quoted->questions[0].values, ElementsAre("fixed", "free"));
  const std::string text = FormatQuestionTable(*quoted);
  EXPECT_EQ(text,
            "class,mobility:property,\"grip, now:state\"\n"
            "\"foil, \"\"thin\"\"\",fixed,firm\n"
            "wood,free,none\n");
  const auto again = ParseQuestionTable(text);
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->class_names, quoted->class_names);
  ExpectSame(again->questions[1], quoted->questions[1]);
}

TEST(QuestionTableTest, ErrorsNameLineAndColumn) {
  const std::pair<std::string, const char*> bad[] = {
      {"", "the label table is empty"},
      {"label,hardness\n", "line 1, column 1 of the label table is \"label\""},
      {"class\nHU\n", "number of questions in line 1"},
      {"class,a,b,c,d,e,f,g,h,i\n", "1 to 8"},
      {"class,a:event\n", "line 1, column 2 of the label table is \"a:event\""},
      {"class,a,\n", "line 1, column 3"},
      {"class,a,b,a\n", "line 1, column 4"},
      {"\nclass,a\nHU,x\nHM\n", "number of cells in line 4"},
      {"class,a\nHU,\n", "line 2, column 2"},
      {"class,a\nHU,x\nHM,y\nHU,y\n", "line 4, column 1"},
      {"class,a\nHU,\"x\n", "line 2 of the label table"},
      {"class,a\nHU,\xff\n", "line 2 of the label table"},
      {"class,a,b\nHU,x,y\nHM,z,y\n", "column 3 of the label table (b)"},
      {"class,a\nHU,x\nHM,\x1b[31m\n", "line 3, column 2"},
      {std::string(1 << 20, 'a'), "bytes of the label table"},
  };
  for (const auto& [text, want] : bad) {
    const auto table = ParseQuestionTable(text);
    EXPECT_EQ(ReasonOf(table.status()), "INVALID_CONFIG") << want;
    EXPECT_THAT(std::string(table.status().message()), HasSubstr(want));
  }
}

TEST(QuestionTableTest, OnlyWhatTheClassesOfTheDataAnswerIsAsked) {
  const auto table = ParseQuestionTable(
      "class,finish,mobility\nwood,rough,fixed\nfoil,smooth,fixed\n"
      "water,wet,free\nstone,rough,fixed\n");
  ASSERT_TRUE(table.ok()) << table.status();
  const auto questions = QuestionsFor(*table, {"stone", "foil"});
  ASSERT_TRUE(questions.ok()) << questions.status();
  ASSERT_EQ(questions->size(), 1u);
  EXPECT_THAT((*questions)[0].values, ElementsAre("rough", "smooth"));
  EXPECT_THAT((*questions)[0].value_of_class, ElementsAre(0, 1));
  EXPECT_TRUE(Validate(*questions, 2).ok());
  EXPECT_THAT(
      std::string(QuestionsFor(*table, {"stone", "gold"}).status().message()),
      HasSubstr("no row of gold"));
  EXPECT_THAT(
      std::string(QuestionsFor(*table, {"stone", "wood"}).status().message()),
      HasSubstr("at least one"));
}

}  // namespace
}  // namespace tactus::internal
