#include "tools/trainctl/report/reproduce_report.h"

#include <filesystem>

#include "absl/strings/str_split.h"
#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/text_boxes.h"
#include "tools/trainctl/command.h"

namespace tactus::internal::client {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

ReproducedRow Known(Algorithm algorithm, absl::string_view features) {
  ReproducedRow row;
  row.experiment = Experiment::kCody;
  row.paper = {algorithm, features, 83.75};
  row.ours_percent = 80;
  row.class_names = {"HU", "SM"};
  row.confusion = {{50, 10}, {14, 46}};
  row.trials = 121;
  row.never_felt = 1;
  row.seconds = 2.5;
  return row;
}

ReproducedRow Failed() {
  ReproducedRow row;
  row.experiment = Experiment::kCody;
  row.paper = {Algorithm::kLstm, "f", 40.42};
  row.reason = "no network";
  return row;
}

std::vector<std::string> Words(const std::string& line) {
  return absl::StrSplit(line, absl::ByAnyChar(" \n"), absl::SkipEmpty());
}

TEST(ReproduceReportTest, ALineSetsOursBesideThePapers) {
  EXPECT_THAT(Words(TableLine(Known(Algorithm::kHmm, "f+m+a"))),
              ElementsAre("HMM", "f+m+a", "80.00", "71.96", "to", "86.18",
                          "83.75", "-3.75", "2.5"));
  ReproducedRow better = Known(Algorithm::kNearest, "a");
  better.ours_percent = 90;
  EXPECT_THAT(Words(TableLine(better)),
              ElementsAre("1-NN", "a", "90.00", "71.96", "to", "86.18", "83.75",
                          "+6.25", "2.5"));
}

TEST(ReproduceReportTest, ALineWithoutAnswerHasTheReason) {
  EXPECT_THAT(
      Words(TableLine(Failed())),
      ElementsAre("LSTM", "f", "-", "-", "40.42", "-", "0.0", "no", "network"));
}

TEST(ReproduceReportTest, ColumnsStandBelowTheirNames) {
  const std::vector<std::string> heading =
      absl::StrSplit(TableHeading(Experiment::kCody), '\n');
  EXPECT_THAT(heading[0], HasSubstr("240 trials of 1.2 s"));
  EXPECT_THAT(heading[0], HasSubstr("tbl:summary_table_exp"));
  const std::string line = TableLine(Known(Algorithm::kHmm, "f+m+a"));
  // Numbers end where their names end.
  EXPECT_EQ(heading[1].find("ours, %") + 7, line.find("80.00") + 5);
  EXPECT_EQ(heading[1].find("paper, %") + 8, line.find("83.75") + 5);
  EXPECT_EQ(heading[1].find("difference") + 10, line.find("-3.75") + 5);
}

TEST(ReproduceReportTest, MatricesOfOneFeatureSetStandSideBySide) {
  const std::string text = ConfusionBlocks(
      {Known(Algorithm::kHmm, "f"), Failed(), Known(Algorithm::kNearest, "f"),
       Known(Algorithm::kHmm, "m")});
  const std::vector<std::string> lines = absl::StrSplit(text, '\n');
  std::vector<std::vector<std::string>> words;
  for (const std::string& line : lines) {
    if (!line.empty()) words.push_back(Words(line));
  }
  ASSERT_EQ(words.size(), 9u);
  EXPECT_THAT(words[1], ElementsAre("HMM", "f", "1-NN", "f"));
  EXPECT_THAT(words[2], ElementsAre("HU", "SM", "HU", "SM"));
  EXPECT_THAT(words[3], ElementsAre("HU", "50", "10", "HU", "50", "10"));
  EXPECT_THAT(words[4], ElementsAre("SM", "14", "46", "SM", "14", "46"));
  EXPECT_THAT(words[5], ElementsAre("HMM", "m"));
}

TEST(ReproduceReportTest, NoMatricesNoText) {
  EXPECT_EQ(ConfusionBlocks({Failed()}), "");
}

TEST(ReproduceReportTest, JsonHasTheNumbersOrNullAndTheReason) {
  const Json known = RowToJson(Known(Algorithm::kHmm, "f+m+a"));
  EXPECT_EQ(known["experiment"], "cody");
  EXPECT_EQ(known["algorithm"], "HMM");
  EXPECT_EQ(known["features"], "f+m+a");
  EXPECT_EQ(known["ours"], 80);
  EXPECT_EQ(known["paper"], 83.75);
  EXPECT_EQ(known["difference"], -3.75);
  EXPECT_EQ(known["confusion"][1][0], 14);
  EXPECT_EQ(known["trials"], 121);
  EXPECT_EQ(known["felt"], 120);
  EXPECT_EQ(known["right"], 96);
  EXPECT_NEAR(known["ours_interval"][0].get<double>(), 71.96, 0.005);
  EXPECT_EQ(known["undetectable"], 1);
  EXPECT_FALSE(known.contains("reason"));
  const Json failed = RowToJson(Failed());
  EXPECT_TRUE(failed["ours"].is_null());
  EXPECT_TRUE(failed["difference"].is_null());
  EXPECT_EQ(failed["reason"], "no network");
}

TEST(ReproduceReportTest, FiguresAreOneOfAllRowsAndOneAMatrix) {
  const fs::path folder =
      fs::path(::testing::TempDir()) / "reproduce" / "figures";
  fs::remove_all(folder);
  ASSERT_TRUE(MakeFolder(folder.string()).ok());
  const absl::Status status = WriteFigures(
      {Known(Algorithm::kHmm, "f+m+a"), Failed()}, folder.string());
  ASSERT_TRUE(status.ok()) << status;
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    names.push_back(entry.path().filename().string());
  }
  EXPECT_THAT(names, UnorderedElementsAre("cody-accuracy.png",
                                          "cody-confusion-hmm-f-m-a.png"));
}

TEST(ReproduceReportTest, BarsHaveIntervalsOfTheContactsCounted) {
  const BarChart chart =
      AccuracyChart({Known(Algorithm::kHmm, "f+m+a"), Failed()});
  ASSERT_THAT(chart.sections, SizeIs(2));
  const auto& bars = chart.sections[0].groups[0].bars;
  EXPECT_EQ(bars[0]->value, 80);
  // Wilson's interval of 96 of the 120 contacts that were felt.
  EXPECT_NEAR(*bars[0]->low, 71.97, 0.01);
  EXPECT_NEAR(*bars[0]->high, 86.17, 0.01);
  EXPECT_FALSE(chart.sections[1].groups[0].bars[0]);
  EXPECT_EQ(chart.sections[1].groups[0].bars[1]->value, 40.42);
  EXPECT_EQ(chart.x_title, "features");
}

TEST(ReproduceReportTest, TheConfusionFigureNamesItsInterval) {
  const ConfusionMatrix figure =
      ConfusionFigure(Known(Algorithm::kHmm, "f+m+a"));
  EXPECT_EQ(figure.subtitle, "96 of 120 right: 80.0 % (95 %: 72.0 to 86.2)");
}

// A chart of the size that `trainctl reproduce` draws.
TEST(ReproduceReportTest, TextsOfTheChartDoNotOverlap) {
  std::vector<ReproducedRow> rows;
  for (const PaperRow& paper : PaperTable(Experiment::kCody)) {
    ReproducedRow row = Known(paper.algorithm, paper.features);
    row.paper = paper;
    row.ours_percent = paper.accuracy_percent + 0.5;
    rows.push_back(row);
  }
  const auto chart = ScriptOf(AccuracyChart(rows));
  ASSERT_TRUE(chart.ok()) << chart.status();
  EXPECT_EQ(CoveredTexts(*chart), "");
  const auto matrix = ScriptOf(ConfusionFigure(rows[0]));
  ASSERT_TRUE(matrix.ok()) << matrix.status();
  EXPECT_EQ(CoveredTexts(*matrix), "");
}

TEST(ReproduceReportTest, AFolderThatCannotBeMadeIsAnIoError) {
  EXPECT_EQ(ReasonOf(MakeFolder("/dev/null/figures")), "IO");
}

}  // namespace
}  // namespace tactus::internal::client
