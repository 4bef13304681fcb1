#include "client/tools/trainctl/evaluate_report.h"

#include "client/tools/trainctl/evaluate_page.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::client {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// `classes` classes; of class k, each of 10 contacts is answered by itself, but
// `wrong[k]` are answered by class 0 with probability 0.9.
Evaluation Made(int classes, const std::vector<int>& wrong) {
  Evaluation result;
  for (int k = 0; k < classes; ++k) {
    result.class_names.push_back("class_" + std::to_string(k) + "<b>");
    for (int i = 0; i < 10; ++i) {
      Outcome outcome;
      outcome.label = k;
      outcome.probability.assign(classes, 0.1 / (classes - 1));
      outcome.probability[i < wrong[k] ? 0 : k] = 0.9;
      result.final.push_back(outcome);
      result.decisions.emplace_back();
      result.final_estimates.emplace_back();
      result.unknown.push_back(0);
    }
  }
  result.anytime.assign(kAnytimeCount, result.final);
  result.anytime_estimates.assign(kAnytimeCount, result.final_estimates);
  return result;
}

TEST(EvaluateReportTest, RecallPrecisionAndConfusionsPerClass) {
  const Json json = EvaluationToJson(Made(3, {0, 4, 1}), 31);
  const Json& classes = json["per_class"];
  EXPECT_EQ(classes[1]["recall"], 0.6);
  EXPECT_EQ(classes[1]["precision"], 1);
  EXPECT_EQ(classes[0]["recall"], 1);
  EXPECT_EQ(classes[0]["answers"], 15);
  EXPECT_EQ(classes[0]["precision"], 10.0 / 15);
  ASSERT_EQ(json["confusions"].size(), 2u);
  EXPECT_EQ(json["confusions"][0]["label"], "class_1<b>");
  EXPECT_EQ(json["confusions"][0]["count"], 4);
  const std::string text = EvaluationText(json);
  const size_t worst = text.find("  class_1<b>  60.00 %");
  const size_t next = text.find("  class_2<b>  90.00 %");
  const size_t best = text.find("  class_0<b>  100.00 %");
  EXPECT_LT(worst, next);
  EXPECT_LT(next, best);
  EXPECT_NE(best, text.npos);
  EXPECT_THAT(text, HasSubstr("class_1<b> taken for class_0<b>: 4\n"));
  EXPECT_THAT(text, HasSubstr("Rows are labels, columns are answers:"));
}

TEST(EvaluateReportTest, AWideMatrixIsLeftToThePage) {
  const Json json = EvaluationToJson(Made(20, std::vector<int>(20, 2)), 200);
  const std::string text = EvaluationText(json);
  EXPECT_THAT(text, Not(HasSubstr("Rows are labels")));
  EXPECT_THAT(text, HasSubstr("--report=FOLDER"));
  for (size_t at = 0; at < text.size();) {
    const size_t end = std::min(text.find('\n', at), text.size());
    EXPECT_LE(end - at, 120u) << text.substr(at, end - at);
    at = end + 1;
  }
}

TEST(EvaluatePageTest, HoldsTheMatrixAndTheWorstTrialsEscaped) {
  const Evaluation result = Made(3, {0, 4, 1});
  std::vector<LabelledContact> contacts(30);
  std::vector<const LabelledContact*> pointers;
  for (int i = 0; i < 30; ++i) {
    contacts[i].id = "trial-" + std::to_string(i);
    pointers.push_back(&contacts[i]);
  }
  const Json worst = WorstTrials(result, pointers);
  ASSERT_EQ(worst.size(), 5u);
  EXPECT_EQ(worst[0]["trial"], "trial-10");
  EXPECT_EQ(worst[0]["answer"], "class_0<b>");
  const std::string html =
      EvaluationPage("a < b", EvaluationToJson(result, 30), worst);
  EXPECT_THAT(html, HasSubstr("<h1>a &lt; b</h1>"));
  EXPECT_THAT(html, HasSubstr("<td class=t>trial-10"));
  EXPECT_THAT(html, HasSubstr("class_0&lt;b&gt;"));
  EXPECT_THAT(html, Not(HasSubstr("<b>")));
}

}  // namespace
}  // namespace tactus::client
