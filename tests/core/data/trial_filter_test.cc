#include "core/data/trial_filter.h"

#include <map>

#include "core/base/errors.h"
#include "core/data/trial_fields.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::map<std::string, std::string> kTrial = {
    {"label", "soft"}, {"day", "2026-02-11"}, {"speed", "0.05"},
    {"who", "Ana B."}, {"empty", ""},         {"in", "x"}};

bool Matches(const std::string& text) {
  const auto filter = TrialFilter::Parse(text);
  EXPECT_TRUE(filter.ok()) << filter.status();
  return filter.ok() &&
         filter->Matches([](const std::string& f) { return kTrial.at(f); });
}

std::string ErrorOf(const std::string& text) {
  const auto filter = TrialFilter::Parse(text);
  EXPECT_EQ(ReasonOf(filter.status()), "INVALID_CONFIG") << text;
  return std::string(filter.status().message());
}

TEST(TrialFilterTest, ComparesTextAndNumbers) {
  EXPECT_TRUE(Matches("label = soft"));
  EXPECT_TRUE(Matches("label=='soft'"));
  EXPECT_FALSE(Matches("label != soft"));
  EXPECT_FALSE(Matches("day != \"2026-02-11\""));
  EXPECT_TRUE(Matches("day>=2026-02-11"));
  EXPECT_TRUE(Matches("day < 2026-02-12"));
  EXPECT_TRUE(Matches("who = 'Ana B.'"));
  EXPECT_TRUE(Matches("empty = ''"));
  // As text, "0.05" is below "5e-2"; as numbers they are equal.
  EXPECT_TRUE(Matches("speed = 5e-2"));
  EXPECT_TRUE(Matches("speed < 0.1"));
  EXPECT_FALSE(Matches("speed > 0.05"));
  EXPECT_TRUE(Matches("speed <= 0.050"));
}

TEST(TrialFilterTest, JoinsComparisons) {
  EXPECT_TRUE(Matches("label in (hard, soft)"));
  EXPECT_FALSE(Matches("label in ('hard')"));
  EXPECT_TRUE(Matches("not label in (hard)"));
  EXPECT_TRUE(Matches("label = hard or label = soft and speed = 0.05"));
  EXPECT_FALSE(Matches("(label = soft or label = soft) and speed = 1"));
  // "and" binds more.
  EXPECT_TRUE(Matches("label = soft or label = soft and speed = 1"));
  EXPECT_FALSE(Matches("not (label = soft or speed = 1)"));
  EXPECT_TRUE(Matches("not not label = soft"));
  EXPECT_TRUE(Matches("in = x and in in (x)"));
}

TEST(TrialFilterTest, NamesTheFieldsOnce) {
  const auto filter = TrialFilter::Parse("b = 1 and (a in (c) or not b != 2)");
  ASSERT_TRUE(filter.ok());
  EXPECT_THAT(filter->fields(), ElementsAre("b", "a"));
}

TEST(TrialFilterTest, MistakesAreNamedWithTheirPlace) {
  EXPECT_THAT(ErrorOf(""), HasSubstr("at character 1 the end"));
  EXPECT_THAT(ErrorOf("label"), HasSubstr("one of = != < <= > >= in"));
  EXPECT_THAT(ErrorOf("label = "), HasSubstr("a value there"));
  EXPECT_THAT(
      ErrorOf("label = a b"),
      HasSubstr("at character 11 \"b\"; it must be and, or, or the end"));
  EXPECT_THAT(ErrorOf("label ~ a"), HasSubstr("\"~\""));
  EXPECT_THAT(ErrorOf("label = 'a"), HasSubstr("the quote ended"));
  EXPECT_THAT(ErrorOf("(label = a"), HasSubstr("\")\""));
  EXPECT_THAT(ErrorOf("label in a"), HasSubstr("\"(\""));
  EXPECT_THAT(ErrorOf("label in (a,"), HasSubstr("a value"));
  EXPECT_THAT(ErrorOf("'label' = a"), HasSubstr("the name of a field"));
  EXPECT_THAT(ErrorOf(std::string(5000, 'a')), HasSubstr("at most 4096"));
  EXPECT_THAT(ErrorOf(std::string(1000, '(') + "a = b"),
              HasSubstr("fewer parentheses"));
  std::string nots;
  for (int i = 0; i < 1000; ++i) nots += "not ";
  EXPECT_THAT(ErrorOf(nots + "a = b"), HasSubstr("fewer nots"));
}

TEST(TrialFieldsTest, AreThoseOfTheTrial) {
  Trial trial;
  trial.id = "7";
  trial.source = "a.csv";
  trial.label = "soft";
  trial.condition = "day 1";
  trial.object = "sponge";
  trial.material = "foam";
  trial.stiffness = 543;
  trial.velocity = 0.05;
  const auto filter = TrialFilter::Parse(
      "trial = 7 and source = a.csv and label = soft and condition = 'day 1' "
      "and object = sponge and group = foam and stiffness = 543 and velocity = "
      "0.05");
  ASSERT_TRUE(filter.ok()) << filter.status();
  EXPECT_TRUE(CheckTrialFields(filter->fields()).ok());
  EXPECT_TRUE(filter->Matches(
      [&](const std::string& field) { return TrialField(trial, field); }));
  EXPECT_THAT(CheckTrialFields({"label", "day"}).message(),
              HasSubstr("one of trial, source, label, condition"));
}

}  // namespace
}  // namespace tactus::internal
