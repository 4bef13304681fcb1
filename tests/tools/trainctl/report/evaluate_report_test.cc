#include "tools/trainctl/report/evaluate_report.h"

#include "absl/strings/escaping.h"
#include "core/base/text.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tools/trainctl/report/evaluate_answers.h"
#include "tools/trainctl/report/evaluate_page.h"
#include "tools/trainctl/report/touch_report.h"

namespace tactus::internal::client {
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

// A touch that is broken in two is right if both answers are.
TEST(EvaluateReportTest, TouchesAreRightIfAllTheirContactsAre) {
  const Evaluation result = Made(2, {0, 1});
  std::vector<LabelledContact> contacts(result.final.size());
  std::vector<const LabelledContact*> pointers;
  for (size_t i = 0; i < contacts.size(); ++i) {
    // Contact 10 is answered wrongly, and is of the touch of contact 11.
    contacts[i].id = i < 12 ? "000000" : "000001";
    contacts[i].touch = i < 11 ? i : i - 1;
    pointers.push_back(&contacts[i]);
  }
  const TouchCounts counts = {.touches = 25,
                              .found = 19,
                              .broken = 1,
                              .merged = 1,
                              .switched = 3,
                              .spurious = 2};
  const Json json = TouchesToJson(counts, result, pointers);
  EXPECT_EQ(json["right"], 18);
  EXPECT_EQ(json["accuracy"], 0.9);
  EXPECT_THAT(TouchesText(json),
              HasSubstr("19 of 25 found, 1 broken, 1 merged, 3 switched; 2 "
                        "contacts at none\n"));
  EXPECT_THAT(TouchesText(json), HasSubstr("90.00 %"));
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

// Contacts with these ids, in the order of `result`.
struct NamedContacts {
  NamedContacts(size_t count, const std::string& prefix) : contacts(count) {
    for (size_t i = 0; i < count; ++i) {
      contacts[i].id = prefix + std::to_string(i);
      pointers.push_back(&contacts[i]);
    }
  }
  std::vector<LabelledContact> contacts;
  std::vector<const LabelledContact*> pointers;
};

TEST(EvaluateAnswersTest, OneLineATrialInTheEnd) {
  Evaluation result = Made(3, {0, 0, 0});
  result.class_names = {"HU", "HM", "foil, \"thin\""};
  result.final = {result.final[0], result.final[10], result.final[20]};
  result.final[1].probability = {0.5, 0.25, 0.25};
  NamedContacts named(3, "trial-");
  for (int i = 0; i < 3; ++i) {
    named.contacts[i].label = result.class_names[i];
    named.contacts[i].frames.push_back_numbers({});
    named.contacts[i].object_motion = {0.0005};
  }
  EXPECT_EQ(
      AnswersCsv(result, named.pointers),
      "trial,label,label_so_far,answer,probability_HU,probability_HM,"
      "\"probability_foil, \"\"thin\"\"\"\n"
      "trial-0,HU,,HU,0.9,0.05,0.05\n"
      "trial-1,HM,HU,HU,0.5,0.25,0.25\n"
      "trial-2,\"foil, \"\"thin\"\"\",,\"foil, \"\"thin\"\"\",0.05,0.05,0.9\n");
}

TEST(EvaluatePageTest, TheWorstTrialsComeFirst) {
  Evaluation result = Made(3, {0, 4, 1});
  // Right, and yet its label got little.
  result.final[25].probability = {0.33, 0.327, 0.343};
  result.final[7].probability = {0.01, 0.59, 0.4};
  const NamedContacts named(30, "trial-");
  const Json worst = WorstTrials(result, named.pointers);
  ASSERT_EQ(worst.size(), 12u);
  EXPECT_EQ(worst[0]["trial"], "trial-7");
  EXPECT_EQ(worst[0]["label"], "class_0<b>");
  EXPECT_EQ(worst[0]["answer"], "class_1<b>");
  EXPECT_EQ(worst[0]["probability"], 0.59);
  EXPECT_EQ(worst[0]["probability_of_label"], 0.01);
  // Five with 0.05, then the uncertain one.
  EXPECT_EQ(worst[1]["trial"], "trial-10");
  EXPECT_EQ(worst[6]["trial"], "trial-25");
  EXPECT_EQ(worst[6]["answer"], worst[6]["label"]);
}

// A model that was asked about hardness and mobility: 20 contacts, 8 of which
// change; of those, one is missed.
Evaluation Asked() {
  Evaluation result = Made(2, {0, 0});
  result.class_names = {"HU", "SM"};
  result.questions = DefaultQuestions({"HU", "SM"});
  result.question_outcomes.resize(2, std::vector<QuestionOutcome>(20));
  for (int i = 0; i < 20; ++i) {
    QuestionOutcome& hardness = result.question_outcomes[0][i];
    hardness.final = {i % 2, {0.75, 0.25}};
    hardness.anytime.assign(kAnytimeCount, hardness.final);
    hardness.timing = {.from_s = 0, .delay_s = 0.25, .false_alarm = i == 0};
    if (i < 5) hardness.decision = {.value = 0, .truth = i == 1 ? 1 : 0};
    hardness.changes = i == 1;
    QuestionOutcome& mobility = result.question_outcomes[1][i];
    mobility.final = {i < 8, {0.25, 0.75}};
    mobility.anytime.assign(kAnytimeCount, mobility.final);
    if (i == 0) {
      mobility.timing = {.from_s = 1.5};
    } else if (i < 8) {
      mobility.timing = {.from_s = 0.5, .delay_s = 0.01 * i};
    } else {
      mobility.timing.false_alarm = i < 11;
    }
  }
  return result;
}

TEST(QuestionReportTest, TheJsonHoldsDelaysAlarmsAndDecisions) {
  const Json json = EvaluationToJson(Asked(), 20);
  for (const char* kept : {"accuracy", "ece", "undetectable", "decision"}) {
    EXPECT_TRUE(json.contains(kept)) << kept;
  }
  const Json& mobility = json["questions"]["mobility"];
  EXPECT_EQ(mobility["kind"], "state");
  EXPECT_DOUBLE_EQ(mobility["delay_ms"]["median"].get<double>(), 40);
  EXPECT_TRUE(mobility["delay_ms"]["p90"].is_null());
  EXPECT_TRUE(mobility["delay_ms"]["p99"].is_null());
  EXPECT_EQ(mobility["delay_ms"]["missed"], 1);
  EXPECT_EQ(mobility["delay_ms_late"]["contacts"], 1);
  EXPECT_TRUE(mobility["delay_ms_late"]["median"].is_null());
  EXPECT_EQ(mobility["false_alarms"], 0.25);
  EXPECT_EQ(mobility["accuracy"], 0.4);
  EXPECT_EQ(mobility["accuracy_at"]["1.2"], 0.4);
  EXPECT_TRUE(mobility["decisions"]["fraction"].is_null());
  const Json& hardness = json["questions"]["hardness"];
  EXPECT_EQ(hardness["delay_ms"]["p99"], 250);
  EXPECT_EQ(hardness["false_alarms"], 0.05);
  EXPECT_EQ(hardness["decisions"]["made"], 5);
  EXPECT_EQ(hardness["decisions"]["right"], 4);
  EXPECT_EQ(hardness["decisions"]["fraction"], 0.8);
  EXPECT_EQ(hardness["decisions"]["revised"], 1);
  EXPECT_EQ(hardness["decisions"]["constant"]["value"], "hard");
  EXPECT_TRUE(
      Json(EvaluationToJson(Made(2, {0, 0}), 20))["questions"].is_null());
}

TEST(QuestionReportTest, TextAndPageShowTheSameFigures) {
  EvaluationPageParts parts;
  parts.evaluation = EvaluationToJson(Asked(), 20);
  const std::string text = EvaluationText(parts.evaluation);
  const std::string page = EvaluationPage(parts);
  for (const char* part :
       {"4 of 5, 80.00 %", "40 / never / never ms, 1 of 8 contacts never",
        "3 of 12, 25.00 %", "always hard"}) {
    EXPECT_THAT(text, HasSubstr(part));
    EXPECT_THAT(page, HasSubstr(part));
  }
  EXPECT_THAT(text, HasSubstr("Question mobility (state):"));
  EXPECT_THAT(page, HasSubstr("Question: mobility"));
}

TEST(EvaluatePageTest, HoldsEveryPart) {
  const NamedContacts named(30, "trial-");
  Evaluation result = Made(3, {0, 4, 1});
  for (int i = 0; i < 20; ++i) {
    result.decisions[i] = DecisionOutcome{0.1 * (i + 1), i != 3};
  }
  EvaluationPageParts parts;
  parts.title = "a < b";
  parts.facts = {{"seed", "71"}};
  parts.evaluation = EvaluationToJson(result, 31);
  parts.baselines = BaselinesToJson({30, 10, 12, 11}, "Tested in 5 folds.");
  parts.worst = WorstTrials(result, named.pointers);
  parts.pictures = {"png-1", "png-2", "png-3", {"png-4"}};
  const std::string html = EvaluationPage(parts);
  for (const char* part :
       {"<h1>a &lt; b</h1>", ">83.33 %<", "25 of 30 felt contacts; 1 of 31",
        "66.44 to 92.66 %", ">71<", ">12 of 30<", ">36.67 %<", ">33.33 %<",
        "Tested in 5 folds.", ">6<br><small>60.0 %<", ">15<", ">66.67 %<",
        ">60.00 %<", ">0.900<", "0.867 to 0.933",
        "20 of 30 felt contacts (66.67 %)", ">1.10<", ">trial-10<",
        "Trial trial-10, label class_1&lt;b&gt;, answer "
        "class_0&lt;b&gt; (probability 0.900)"}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
  for (const char* png : {"png-1", "png-2", "png-3", "png-4"}) {
    EXPECT_THAT(html, HasSubstr("src=\"data:image/png;base64," +
                                absl::Base64Escape(png) + "\""));
  }
  // Nothing comes from elsewhere.
  for (const char* elsewhere : {"http", "url(", "href", "<script", "<link"}) {
    EXPECT_THAT(html, Not(HasSubstr(elsewhere)));
  }
}

TEST(EvaluatePageTest, NamesCannotBecomeMarkup) {
  const std::string bad = "<script>\"'&\x01\xff</td> \u05d0";
  Evaluation result = Made(3, {1, 4, 1});
  for (std::string& name : result.class_names) name += bad;
  const NamedContacts named(30, bad);
  EvaluationPageParts parts;
  parts.title = bad;
  parts.facts = {{bad, bad}};
  parts.evaluation = EvaluationToJson(result, 30);
  parts.baselines = BaselinesToJson({30, 10, 12, 11}, bad);
  parts.worst = WorstTrials(result, named.pointers);
  parts.pictures.worst.assign(parts.worst.size(), "png");
  const std::string html = EvaluationPage(parts);
  EXPECT_TRUE(IsUtf8(html));
  EXPECT_THAT(html, Not(HasSubstr("<script")));
  EXPECT_THAT(html, Not(HasSubstr("<b>")));
  EXPECT_THAT(html, Not(HasSubstr("\x01")));
  const std::string good =
      "&lt;script&gt;&quot;&#39;&amp;\uFFFD\uFFFD&lt;/td&gt; \u05d0";
  EXPECT_THAT(html, HasSubstr("<title>" + good + "</title>"));
  EXPECT_THAT(html, HasSubstr("<bdi>class_1&lt;b&gt;" + good + "</bdi></th>"));
  EXPECT_THAT(html, HasSubstr("alt=\"Trial " + good));
  // As many ends of cells as beginnings.
  const auto count = [&](const std::string& part) {
    int n = 0;
    for (size_t at = html.find(part); at != html.npos;
         at = html.find(part, at + 1)) {
      ++n;
    }
    return n;
  };
  EXPECT_EQ(count("<td"), count("</td>"));
  EXPECT_EQ(count("<bdi>"), count("</bdi>"));
}

// What a server measures has no probabilities, decisions or trials.
TEST(EvaluatePageTest, LeavesOutWhatIsNotThere) {
  Json json = EvaluationToJson(Made(3, {0, 4, 1}), 30);
  for (const char* key : {"reliability", "decision", "ece_at"}) json.erase(key);
  json["parts_accuracy_at"] = nullptr;
  EvaluationPageParts parts;
  parts.title = "short";
  parts.evaluation = json;
  const std::string html = EvaluationPage(parts);
  EXPECT_THAT(html, HasSubstr("Confusion matrix"));
  for (const char* part : {"baselines", "Reliability", "Time to decision",
                           "worst", "<img", "calibration"}) {
    EXPECT_THAT(html, Not(HasSubstr(part)));
  }
}

}  // namespace
}  // namespace tactus::internal::client
