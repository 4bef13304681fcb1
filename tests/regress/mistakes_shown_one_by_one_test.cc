// Only the first mistake of a set of files was named, and files
// with a frame that was stored twice had to be edited one by one. Times of
// another unit were refused without a word about units.
#include <string>

#include "absl/strings/str_cat.h"
#include "core/import/rate_check.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/data/trial_samples.h"
#include "tests/core/import/import_all.h"

namespace tactus::internal {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class MistakesTest : public ::testing::Test {
 protected:
  MistakesTest() { Skin(""); }
  void Write(const std::string& name, const std::string& text) {
    WriteBytes(dir_ / name, text);
  }
  void Skin(const std::string& more) {
    Write("skin.json", absl::StrCat(R"({"name": "s", "rows": 1, "columns": 2,
      "row_pitch_m": 0.01, "column_pitch_m": 0.01, "unit": "counts",
      "contact_threshold": 20, "sample_rate_hz": 50)",
                                    more, "}"));
  }
  absl::StatusOr<std::vector<Trial>> Import() {
    remarks_.clear();
    ImportOptions options;
    options.remark = [&](const std::string& text) { remarks_ += text + "\n"; };
    return ImportAll(dir_.path(), options);
  }
  std::string Error() { return std::string(Import().status().message()); }

  const ScratchDir dir_;
  std::string remarks_;
};

constexpr char kTwice[] = "time,p,q\n0,1,2\n0.02,3,4\n0.02,3,4\n0.04,5,6\n";

TEST_F(MistakesTest, AllAreInOneError) {
  Write("trials.csv", "frames,label\na.csv,x\nb.csv,x\nc.csv,y\nd.csv,y\n");
  Write("a.csv", "time,p,q\n0,1,2\n0.02,3,4\n");
  Write("b.csv", kTwice);
  Write("c.csv", "time,p,q\n0,1,nan\n0.02,3,4\n");
  Write("d.csv", kTwice);
  EXPECT_THAT(Error(),
              AllOf(HasSubstr("trials.csv: has 3 mistakes: (1) line 3: time: "),
                    HasSubstr("the same in line 5 (d.csv)"),
                    HasSubstr("(2) line 4: frames: "),
                    HasSubstr("\"repeated_times\": \"dropped\"")));
}

TEST_F(MistakesTest, TheErrorIsBounded) {
  std::string table = "frames,label\n";
  for (int i = 0; i < 100; ++i) absl::StrAppend(&table, "no", i, ".csv,x\n");
  Write("trials.csv", table);
  EXPECT_THAT(Error(),
              AllOf(HasSubstr("has 100 mistakes"), HasSubstr("no19.csv"),
                    Not(HasSubstr("no20.csv")), HasSubstr("and 80 more")));
}

TEST_F(MistakesTest, RepeatedTimesAreDroppedIfTheSkinSaysSo) {
  Skin(R"(, "repeated_times": "dropped")");
  Write("trials.csv", "frames,label\na.csv,x\nb.csv,x\n");
  Write("a.csv", kTwice);
  Write("b.csv", kTwice);
  const auto trials = Import();
  ASSERT_TRUE(trials.ok()) << trials.status();
  EXPECT_THAT((*trials)[1].time, ElementsAre(0, 0.02, 0.04));
  EXPECT_THAT((*trials)[1].taxels.f32, ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_THAT(remarks_, HasSubstr("2 frames of 2 trials were dropped"));
  // Times that run backwards are a mistake all the same.
  Write("a.csv", "time,p,q\n0,1,2\n0.02,3,4\n0.01,3,4\n");
  EXPECT_THAT(Error(), HasSubstr("time: that of frame 2 is 0.01 s"));
}

TEST_F(MistakesTest, AnotherRateIsNamedOrRemarkedUpon) {
  Write("trials.csv", "frames,label\na.csv,x\n");
  Write("a.csv", "time,p,q\n0,1,2\n20,3,4\n40,3,4\n");
  EXPECT_THAT(Error(),
              AllOf(HasSubstr("are those of 0.05 frames a second"),
                    HasSubstr("\"time_scale_s\""), HasSubstr("by 0.001")));
  Write("a.csv", "time,p,q\n0,1,2\n0.022,3,4\n0.044,3,4\n");
  ASSERT_TRUE(Import().ok());
  EXPECT_THAT(remarks_, HasSubstr("another rate than 50 Hz: 45.45"));
  Write("a.csv", "time,p,q\n0,1,2\n0.0201,3,4\n0.0399,3,4\n");
  ASSERT_TRUE(Import().ok());
  EXPECT_THAT(remarks_, Not(HasSubstr("another rate")));
}

TEST(RateCheckTest, NamesTheFactorOfAnotherUnit) {
  EXPECT_THAT(CheckRate({0, 20, 40}, 50).advice, HasSubstr("by 0.001"));
  EXPECT_THAT(CheckRate({0, 2e4, 4e4}, 50).advice, HasSubstr("by 1e-06"));
  EXPECT_THAT(CheckRate({0, 2e7, 4e7}, 50).advice, HasSubstr("by 1e-09"));
  EXPECT_THAT(CheckRate({0, 2e-5, 4e-5}, 50).advice, HasSubstr("by 1000"));
  EXPECT_THAT(CheckRate({0, 0.03, 0.06}, 50).error, HasSubstr("33.33"));
  EXPECT_EQ(CheckRate({0, 0.03, 0.06}, 50).advice, "");
  EXPECT_EQ(CheckRate({0, 0.02, 0.04}, 50).error, "");
  EXPECT_EQ(CheckRate({0}, 50).error, "");
}

}  // namespace
}  // namespace tactus::internal
