#include "core/data/trial_layout.h"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "core/base/errors.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

std::string Write(const std::string& text) {
  const std::string path = ::testing::TempDir() + "trial_layout_test.json";
  std::ofstream(path) << text;
  return path;
}

// The example of docs/formats.md.
TEST(ReadLayoutFileTest, ReadsTheDocumentedExample) {
  const char* root = std::getenv("TACTUS_SOURCE_DIR");
  std::ifstream page(std::string(root == nullptr ? "." : root) +
                     "/docs/formats.md");
  const std::string text{std::istreambuf_iterator<char>(page), {}};
  const std::string begin = "```json\n";
  const size_t from = text.find(begin);
  ASSERT_NE(from, text.npos);
  const size_t to = text.find("```", from + begin.size());
  const std::string path =
      Write(text.substr(from + begin.size(), to - from - begin.size()));
  const auto layout = ReadLayoutFile(path);
  std::remove(path.c_str());
  ASSERT_TRUE(layout.ok()) << layout.status();
  SkinLayout want = {.name = "my-palm",
                     .rows = 8,
                     .columns = 8,
                     .row_pitch_m = 0.005,
                     .column_pitch_m = 0.005,
                     .taxel_area_m2 = 2.5e-5,
                     .wrap_columns = false,
                     .unit = TaxelUnit::kNewton,
                     .contact_threshold = 0.01,
                     .onset_threshold = 0.02,
                     .connectivity = Connectivity::kEight,
                     .mask = std::vector<uint8_t>(64, 1),
                     .light_touch = LightTouch{0.1, 3, 3, 0.0004, 0.0006},
                     .axes = 3,
                     .normal_axis = 2,
                     .signed_values = true};
  want.mask[0] = 0;
  want.mask[7] = 0;
  EXPECT_EQ(*layout, want);
}

TEST(ReadLayoutFileTest, ErrorsNameWhatIsWrong) {
  EXPECT_EQ(ReasonOf(ReadLayoutFile("/no/such.json").status()), "IO");
  const std::pair<const char*, const char*> cases[] = {
      {"{", "INVALID_CONFIG"},
      {R"({"no_such_field": 1})", "INVALID_CONFIG"},
      {R"({"layout": "moon"})", "UNKNOWN_LAYOUT"},
      {R"({"layout": "mine", "rows": 8})", "INVALID_CONFIG"},
  };
  for (const auto& [text, reason] : cases) {
    const std::string path = Write(text);
    const absl::Status status = ReadLayoutFile(path).status();
    EXPECT_EQ(ReasonOf(status), reason) << status;
    EXPECT_NE(status.message().find(path), std::string::npos) << status;
    std::remove(path.c_str());
  }
}

TEST(LayoutOfTrialTest, TakesTheGivenLayoutOrAPreset) {
  Trial trial;
  trial.layout = "cody-forearm";
  trial.taxels.rows = 16;
  trial.taxels.columns = 24;
  EXPECT_EQ(*LayoutOfTrial(trial), *LayoutPreset("cody-forearm"));
  SkinLayout mine = *LayoutPreset("cody-forearm");
  mine.name = "mine";
  mine.wrap_columns = false;
  EXPECT_EQ(*LayoutOfTrial(trial, &mine), *LayoutPreset("cody-forearm"));
  trial.layout = "mine";
  EXPECT_EQ(*LayoutOfTrial(trial, &mine), mine);
  EXPECT_EQ(ReasonOf(LayoutOfTrial(trial).status()), "UNKNOWN_LAYOUT");
  mine.rows = 12;
  EXPECT_EQ(ReasonOf(LayoutOfTrial(trial, &mine).status()), "INVALID_CONFIG");
}

// A layout that is given beside the trial's own must not differ from it.
TEST(LayoutOfTrialTest, TakesTheSkinThatTheTrialCarries) {
  Trial trial;
  trial.taxels.rows = 16;
  trial.taxels.columns = 24;
  SkinLayout mine = *LayoutPreset("cody-forearm");
  mine.name = "mine";
  mine.contact_threshold = 0.005;
  SetSkin(mine, trial);
  EXPECT_EQ(*LayoutOfTrial(trial), mine);
  EXPECT_EQ(*LayoutOfTrial(trial, &mine), mine);
  SkinLayout other = mine;
  other.contact_threshold = 0.01;
  const absl::Status status = LayoutOfTrial(trial, &other).status();
  EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG");
  EXPECT_NE(status.message().find("contact_threshold 0.01, not 0.005"),
            std::string::npos)
      << status;
  // One of another name is not for this trial.
  other.name = "other";
  EXPECT_EQ(*LayoutOfTrial(trial, &other), mine);
}

TEST(LayoutOfTrialTest, RefusesAnotherUnit) {
  Trial trial;
  trial.layout = "vitac-12x32";
  trial.taxels.rows = 12;
  trial.taxels.columns = 32;
  trial.unit = "newton";
  EXPECT_EQ(ReasonOf(LayoutOfTrial(trial).status()), "INVALID_CONFIG");
  trial.unit = "counts";
  EXPECT_TRUE(LayoutOfTrial(trial).ok());
}

}  // namespace
}  // namespace tactus::internal
