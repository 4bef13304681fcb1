// The probability of a value was the sum of those of its classes, which
// rounding put above 1. The client refused such answers, and the stream ended.
#include <array>

#include "core/questions/question.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

TEST(ProbabilityAboveOneTest, AValueOfAllLikelyClassesHasOne) {
  const Question question = {
      "hardness", Question::kProperty, {"hard", "soft"}, {0, 0, 0, 0, 1}};
  const std::array<double, 5> classes = {0.2, 0.4, 0.3, 0.1, 0};
  ASSERT_GT(classes[0] + classes[1] + classes[2] + classes[3], 1);
  std::array<double, 2> values = {};
  ValueProbability(question, classes, values);
  EXPECT_EQ(values[0], 1);
  EXPECT_EQ(values[1], 0);
}

}  // namespace
}  // namespace tactus::internal
