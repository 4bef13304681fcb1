// The demo said "accuracy 1.0000" although 13 of 54 decisions named another
// class than the label and 5 contacts of one class were never felt.
#include <cstdio>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tools/stream/report.h"

namespace tactus::internal::client {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// Class numbers: 0 HU, 1 HM, 2 SU, 3 SM.
TrialResult Felt(size_t index, int label, int answer,
                 std::optional<int> decision) {
  TrialResult result;
  result.index = index;
  result.id = "trial-" + std::to_string(index);
  result.label = label;
  result.answer = answer;
  result.detected = true;
  result.probability = {0.1, 0.2, 0.3, 0.4};
  result.decision = decision;
  result.decision_ms = 200;
  return result;
}

TrialResult NeverFelt(size_t index, int label) {
  TrialResult result;
  result.index = index;
  result.id = "trial-" + std::to_string(index);
  result.label = label;
  return result;
}

class Capture {
 public:
  Capture() : file_(std::tmpfile()), report(file_) {
    report.SetClassNames({"HU", "HM", "SU", "SM"});
  }
  ~Capture() { std::fclose(file_); }

  std::string Text() const {
    std::string text(std::ftell(file_), '\0');
    std::rewind(file_);
    EXPECT_EQ(std::fread(text.data(), 1, text.size(), file_), text.size());
    return text;
  }

 private:
  std::FILE* const file_;

 public:
  Report report;
};

// Six trials: one never felt, one wrong, one decided wrongly, one undecided.
void AddAll(Report& report) {
  report.Add(Felt(4, 3, 1, 3));
  report.Add(Felt(0, 0, 0, 0));
  report.Add(NeverFelt(2, 3));
  report.Add(Felt(1, 1, 1, 0));
  report.Add(Felt(5, 2, 2, 2));
  report.Add(Felt(3, 2, 2, std::nullopt));
}

std::vector<std::string> WordsOf(const std::string& text,
                                 const std::string& first) {
  std::vector<std::string> words;
  const size_t at = text.find("\n" + first + " ");
  EXPECT_NE(at, std::string::npos) << first;
  std::string word;
  for (const char c : text.substr(at + 1, text.find('\n', at + 1) - at)) {
    if (c != ' ' && c != '\n') {
      word += c;
    } else if (!word.empty()) {
      words.push_back(std::move(word));
      word.clear();
    }
  }
  return words;
}

TEST(SummaryOfTheDemoTest, CountsWhatWasFeltAnsweredAndDecided) {
  Capture capture;
  AddAll(capture.report);
  capture.report.PrintSummary();
  const std::string text = capture.Text();
  // trials, felt, never felt, right, wrong, decided right, wrong, undecided.
  EXPECT_THAT(WordsOf(text, "hard-moved"),
              ::testing::ElementsAre("hard-moved", "1", "1", "0", "1", "0", "0",
                                     "1", "0"));
  EXPECT_THAT(WordsOf(text, "soft-moved"),
              ::testing::ElementsAre("soft-moved", "2", "1", "1", "0", "1", "1",
                                     "0", "0"));
  EXPECT_THAT(
      WordsOf(text, "all"),
      ::testing::ElementsAre("all", "6", "5", "1", "4", "1", "3", "1", "1"));
  EXPECT_THAT(text,
              AllOf(HasSubstr("felt: 5 of 6 (83.3 %); never felt: 1"),
                    HasSubstr("right at the end of the contact: 4 of 5 (80.0 "
                              "%) of those felt"),
                    HasSubstr("decided rightly: 3 of 5 (60.0 %) of those felt; "
                              "decided wrongly: 1; undecided: 1")));
}

TEST(SummaryOfTheDemoTest, ContactsStandInOrderBelowAHeader) {
  Capture capture;
  AddAll(capture.report);
  capture.report.PrintSummary();
  const std::string text = capture.Text();
  EXPECT_EQ(text.find("trial "), 0u);
  size_t last = 0;
  for (int i = 0; i < 6; ++i) {
    const size_t at = text.find("trial-" + std::to_string(i));
    ASSERT_NE(at, std::string::npos) << i;
    EXPECT_GT(at, last) << i;
    last = at;
  }
}

// A trial that a failed stream never ended does not hide those behind it.
TEST(SummaryOfTheDemoTest, AMissingContactHidesNoOther) {
  Capture capture;
  capture.report.Add(Felt(0, 0, 0, 0));
  capture.report.Add(Felt(2, 0, 0, 0));
  capture.report.PrintSummary();
  EXPECT_THAT(capture.Text(), HasSubstr("trial-2"));
}

TEST(SummaryOfTheDemoTest, JsonKeepsItsFieldsAndHasTheNewOnes) {
  Capture capture;
  AddAll(capture.report);
  const Json json = capture.report.ToJson();
  for (const char* field :
       {"trials", "accuracy", "confusion", "decision_ms", "rtt_us", "frames",
        "lost", "undetectable", "resumed"}) {
    EXPECT_TRUE(json.contains(field)) << field;
  }
  EXPECT_EQ(json["accuracy"], 0.8);
  EXPECT_EQ(json["undetectable"], 1);
  EXPECT_EQ(json["felt"], 5);
  EXPECT_EQ(json["decided_right"], 3);
  EXPECT_EQ(json["decided_wrong"], 1);
  EXPECT_EQ(json["undecided"], 1);
  EXPECT_EQ(json["classes"][3]["words"], "soft-moved");
  EXPECT_EQ(json["classes"][3]["never_felt"], 1);
}

}  // namespace
}  // namespace tactus::internal::client
