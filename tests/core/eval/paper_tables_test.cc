#include "core/eval/paper_tables.h"

#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/shared_data.h"

namespace tactus::internal {
namespace {

constexpr Experiment kExperiments[] = {Experiment::kSimulation,
                                       Experiment::kCody};

TEST(PaperTablesTest, EveryFeatureSetOfEveryAlgorithmIsThereOnce) {
  for (Experiment experiment : kExperiments) {
    std::map<std::string, int> seen;
    for (const PaperRow& row : PaperTable(experiment)) {
      ++seen[absl::StrCat(PaperName(row.algorithm), " ", row.features)];
    }
    EXPECT_EQ(seen.size(), 21u);
    for (const auto& [row, count] : seen) EXPECT_EQ(count, 1) << row;
  }
}

TEST(PaperTablesTest, FeaturesAreReadInOrder) {
  EXPECT_THAT(PaperFeatures("f+m+a"),
              ::testing::ElementsAre(Feature::kForce, Feature::kMotion,
                                     Feature::kArea));
  EXPECT_THAT(PaperFeatures("a"), ::testing::ElementsAre(Feature::kArea));
}

// An accuracy over n trials is a whole number of trials; the paper cuts
// digits rather than rounding them. The simulation's LSTM rows are none
// (paper_tables.h).
TEST(PaperTablesTest, AccuraciesAreWholeNumbersOfTrials) {
  for (Experiment experiment : kExperiments) {
    const double trials = SourceOf(experiment).trials;
    for (const PaperRow& row : PaperTable(experiment)) {
      if (experiment == Experiment::kSimulation &&
          row.algorithm == Algorithm::kLstm) {
        continue;
      }
      const double right = std::round(row.accuracy_percent / 100 * trials);
      EXPECT_NEAR(100 * right / trials, row.accuracy_percent, 0.01)
          << PaperName(row.algorithm) << " " << row.features;
    }
  }
}

// Rows of the table with this label: "HMM f+m" -> "82.13".
std::map<std::string, std::string> ReadTable(const std::string& tex,
                                             absl::string_view label) {
  std::map<std::string, std::string> rows;
  const size_t end = tex.find(absl::StrCat("\\caption{\\label{", label, "}"));
  if (end == std::string::npos) return rows;
  const size_t begin = tex.rfind("\\begin{tabular}", end);
  std::istringstream lines(tex.substr(begin, end - begin));
  for (std::string line; std::getline(lines, line);) {
    const std::string bare = absl::StrReplaceAll(
        line, {{" ", ""}, {"\\\\", ""}, {"\\bf{", ""}, {"}", ""}});
    const std::vector<std::string> cells = absl::StrSplit(bare, '&');
    if (cells.size() == 3) {
      rows[absl::StrCat(cells[0], " ", cells[1])] = cells[2];
    }
  }
  return rows;
}

TEST(PaperTablesTest, NumbersAreThoseOfThePapersSource) {
  const std::string path = SharedDataPath("../paper.tex");
  std::ifstream file(path);
  if (!file)
    GTEST_SKIP() << path << " is absent: it is not part of the project";
  std::stringstream tex;
  tex << file.rdbuf();
  for (Experiment experiment : kExperiments) {
    const PaperSource source = SourceOf(experiment);
    const auto rows = ReadTable(tex.str(), source.table);
    for (const PaperRow& row : PaperTable(experiment)) {
      const std::string key =
          absl::StrCat(PaperName(row.algorithm), " ", row.features);
      ASSERT_TRUE(rows.contains(key)) << key;
      double printed = 0;
      ASSERT_TRUE(absl::SimpleAtod(rows.at(key), &printed)) << rows.at(key);
      EXPECT_EQ(row.accuracy_percent, printed) << source.table << " " << key;
    }
    double majority = 0;
    ASSERT_TRUE(rows.contains("MajorityClassifier "));
    ASSERT_TRUE(absl::SimpleAtod(rows.at("MajorityClassifier "), &majority));
    EXPECT_EQ(source.majority_percent, majority);
  }
}

}  // namespace
}  // namespace tactus::internal
