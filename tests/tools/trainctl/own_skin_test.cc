// The commands that a user with an own skin runs, one after another.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "absl/strings/escaping.h"
#include "absl/strings/str_format.h"
#include "core/base/errors.h"
#include "core/base/random.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/png_image.h"
#include "tests/support/trainctl_run.h"

namespace tactus::internal {
namespace {

using client::Json;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::RunTrainctl;
namespace fs = std::filesystem;

// Twelve presses on each of two places of a 2 x 8 skin, as CSV.
class OwnSkinTest : public ::testing::Test {
 protected:
  OwnSkinTest() : folder_(fs::path(::testing::TempDir()) / "own_skin") {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    std::ofstream(folder_ / "skin.json") << kSkin;
    std::ofstream table(folder_ / "trials.csv");
    table << "frames,label,group\n";
    for (int i = 0; i < 24; ++i) {
      const std::string name = absl::StrFormat("t%02d.csv", i);
      table << name << "," << (i % 2 == 0 ? "left" : "right") << ",g" << i % 4
            << "\n";
      WriteFrames(name, i);
    }
  }
  ~OwnSkinTest() override { fs::remove_all(folder_); }

  static constexpr char kSkin[] = R"({"name": "mine", "rows": 2, "columns": 8,
    "row_pitch_m": 0.01, "column_pitch_m": 0.01, "unit": "counts",
    "thresholds": "from idle frames", "idle_frames": 10,
    "sample_rate_hz": 50})";

  void WriteFrames(const std::string& name, int number) {
    Random random(number);
    std::ofstream file(folder_ / name);
    for (int t = 0; t < 60; ++t) {
      for (int i = 0; i < 16; ++i) {
        const bool here = i % 8 == (number % 2 == 0 ? 1 : 6);
        const double load = t >= 10 && here ? std::min(200, 20 * (t - 9)) : 0;
        file << (i > 0 ? "," : "") << load + random.Index(4);
      }
      file << "\n";
    }
  }
  std::string Path(const std::string& name) const { return folder_ / name; }
  std::string Page() const {
    std::ifstream page(folder_ / "page/index.html");
    return {std::istreambuf_iterator<char>(page), {}};
  }
  // Widths of all pictures in the page, which are decoded.
  static std::vector<int> Widths(const std::string& html) {
    const std::string begin = "src=\"data:image/png;base64,";
    std::vector<int> widths;
    for (size_t at = html.find(begin); at != html.npos;
         at = html.find(begin, at)) {
      at += begin.size();
      std::string png;
      EXPECT_TRUE(
          absl::Base64Unescape(html.substr(at, html.find('"', at) - at), &png));
      widths.push_back(client::DecodePng(png).width);
    }
    return widths;
  }
  Json Run(const std::string& arguments) {
    const auto run = RunTrainctl(arguments + " --json");
    EXPECT_TRUE(run.status.ok()) << run.status;
    return run.status.ok() ? Json::parse(run.out) : Json();
  }

  const fs::path folder_;
};

TEST_F(OwnSkinTest, FromFramesToAnAnswerWithoutALayout) {
  const std::string data = Path("mine.h5");
  const Json imported = Run("import " + folder_.string() + " --out=" + data);
  EXPECT_EQ(imported["trials"], 24);
  EXPECT_EQ(imported["groups"], 4);
  EXPECT_EQ(imported["skin"]["layout"], "mine");
  // Noise of 0 to 3, median at most 2, peaks of 200 and noise.
  const double threshold = imported["skin"]["contact_threshold"];
  EXPECT_GT(threshold, 6.9);
  EXPECT_LT(threshold, 7.1);

  const Json estimate = Run("skin estimate " + data);
  EXPECT_EQ(estimate["contact_threshold"], threshold);
  EXPECT_EQ(estimate["values"], 24 * 10 * 16);

  const Json inspected = Run("inspect " + data);
  EXPECT_EQ(inspected["skins"].size(), 1u);
  EXPECT_EQ(inspected["contacts"]["felt"], 24);
  EXPECT_EQ(inspected["contacts"]["idle_before_onset"]["largest"], 3);
  EXPECT_EQ(inspected["contacts"]["taxels_of_largest_region"]["median"], 2);
  EXPECT_EQ(inspected["contacts"]["taxels_always_touched"], Json::array());
  EXPECT_EQ(inspected["contacts"]["taxels_never_touched"],
            Json({0, 2, 3, 4, 5, 7, 8, 10, 11, 12, 13, 15}));
  EXPECT_LT(inspected["contacts"]["change_per_frame"]["median"], 0.2);
  EXPECT_NEAR(inspected["contacts"]["contact_s"]["median"].get<double>(), 1,
              1e-9);

  // No poses: the preset is chosen. The place alone tells the classes apart.
  const std::string bundle = Path("mine.tactus");
  const Json fitted =
      Run("fit --choice-work=0 --data=" + data + " --out=" + bundle);
  EXPECT_EQ(fitted["preset"], "profile");
  EXPECT_EQ(fitted["choice"]["chance"], 0.5);
  EXPECT_GE(fitted["choice"]["nearest_accuracy"], 0.9);
  EXPECT_EQ(fitted["choice"]["hmm_accuracy"]["profile"], 1);

  const Json evaluated = Run("evaluate --data=" + data + " --model=" + bundle);
  EXPECT_EQ(evaluated["right"], 24);
  const Json answers = Run("classify --data=" + data + " --model=" + bundle);
  for (const Json& answer : answers["trials"]) {
    EXPECT_EQ(answer["answer"], answer["label"]);
  }
}

// Other thresholds in the trials than in the bundle are not used silently.
TEST_F(OwnSkinTest, AnotherSkinIsRefused) {
  const std::string data = Path("mine.h5");
  const std::string bundle = Path("mine.tactus");
  Run("import " + folder_.string() + " --out=" + data);
  Run("fit --preset=profile --data=" + data + " --out=" + bundle);
  std::ofstream(folder_ / "other.json") << R"({"name": "mine", "rows": 2,
    "columns": 8, "row_pitch_m": 0.01, "column_pitch_m": 0.01,
    "unit": "counts", "contact_threshold": 6, "sample_rate_hz": 50})";
  const std::string other = Path("other.h5");
  Run("import " + data + " --skin=" + Path("other.json") + " --out=" + other);
  for (const std::string command : {"evaluate", "classify"}) {
    const auto run =
        RunTrainctl(command + " --data=" + other + " --model=" + bundle);
    EXPECT_EQ(ReasonOf(run.status), "INVALID_CONFIG") << command;
    EXPECT_THAT(std::string(run.status.message()),
                HasSubstr("contact_threshold 6, not "));
  }
}

TEST_F(OwnSkinTest, ReportsShowRecallAndTheMatrixGoesToThePage) {
  const std::string data = Path("mine.h5");
  Run("import " + folder_.string() + " --out=" + data);
  const std::string command =
      "evaluate --protocol=k-fold --folds=3 "
      "--preset=profile --data=" +
      data;
  auto run = RunTrainctl(command + " --report=" + Path("page"));
  ASSERT_TRUE(run.status.ok()) << run.status;
  EXPECT_THAT(run.out, HasSubstr("Recall per class, the worst first:\n  left"));
  EXPECT_THAT(run.out, HasSubstr("Rows are labels"));
  const std::string html = Page();
  EXPECT_THAT(html, HasSubstr("<h2>Confusion matrix</h2>"));
  EXPECT_THAT(html, HasSubstr("<bdi>left</bdi></th>"));
  EXPECT_THAT(html, HasSubstr("<bdi>k-fold, 3 folds</bdi>"));
  EXPECT_THAT(html, HasSubstr("mine: 2 x 8 taxels, counts; contact from "));
  EXPECT_THAT(html, HasSubstr("same folds as the models: k-fold"));
  // Accuracy over time, reliability, decisions, and the twelve worst trials.
  const std::vector<int> widths = Widths(html);
  ASSERT_EQ(widths.size(), 15u);
  for (size_t i = 3; i < widths.size(); ++i) EXPECT_EQ(widths[i], 1600);
  for (const char* elsewhere : {"<script", "http", "href", "url("}) {
    EXPECT_THAT(html, Not(HasSubstr(elsewhere)));
  }
}

TEST_F(OwnSkinTest, APageOfABundleShowsItsPosteriors) {
  const std::string data = Path("mine.h5");
  const std::string bundle = Path("mine.tactus");
  Run("import " + folder_.string() + " --out=" + data);
  Run("fit --preset=profile --data=" + data + " --out=" + bundle);
  auto run = RunTrainctl("evaluate --data=" + data + " --model=" + bundle +
                         " --report=" + Path("page"));
  ASSERT_TRUE(run.status.ok()) << run.status;
  const std::string html = Page();
  EXPECT_THAT(html, HasSubstr("<bdi>" + bundle + "</bdi>"));
  EXPECT_THAT(html, HasSubstr("5 folds of these trials"));
  EXPECT_EQ(Widths(html).size(), 15u);
}

// A folder that cannot be made is found before the work.
TEST_F(OwnSkinTest, APageNeedsItsFolder) {
  std::ofstream(folder_ / "page") << "a file";
  auto run = RunTrainctl(
      "evaluate --protocol=k-fold --data=absent.h5 --report=" + Path("page"));
  EXPECT_EQ(ReasonOf(run.status), "IO");
  EXPECT_THAT(std::string(run.status.message()), HasSubstr(Path("page")));
}

}  // namespace
}  // namespace tactus::internal
