// What a first import left unsaid: taxels without a skin.json were taken for
// signals, skin.json's mistakes came one at a time, and a skin that rests above
// its contact threshold was in touch in every frame without a word.
#include <filesystem>
#include <fstream>
#include <string>

#include "absl/status/status.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/scratch_dir.h"
#include "tests/support/trainctl_run.h"

namespace tactus::internal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::RunTrainctl;

class FirstImportTest : public ::testing::Test {
 protected:
  // Four recordings of a skin of 2 x 3 taxels that rests at 100 counts.
  FirstImportTest() {
    for (const char* name : {"hard_0", "hard_1", "soft_0", "soft_1"}) {
      std::ofstream file(folder_ / (std::string(name) + ".csv"));
      file << "time,t0,t1,t2,t3,t4,t5\n";
      for (int t = 0; t < 20; ++t) {
        file << t / 100.0 << ",100,101,99,100," << 100 + t % 7 * (name[5] + 1)
             << "," << (name[0] == 'h' ? 100 + t : 100) << "\n";
      }
    }
  }
  void Skin(const std::string& text) const {
    std::ofstream(folder_ / "skin.json") << text;
  }
  // What `trainctl import` reports and remarks.
  struct Said {
    absl::Status status;
    std::string remarks;
  };
  Said Import(const std::string& options) const {
    ::testing::internal::CaptureStderr();
    const auto run = RunTrainctl("import " + (folder_ / "") + " --out=" +
                                 (folder_ / "out.h5") + " " + options);
    return {run.status, ::testing::internal::GetCapturedStderr()};
  }
  Said Import() const { return Import("--file-names={label}_{}.csv"); }

  ScratchDir folder_;
};

TEST_F(FirstImportTest, TaxelsWithoutASkinGetTheNextStep) {
  EXPECT_THAT(std::string(Import("").status.message()),
              HasSubstr("describe the skin in a skin.json"));
}

TEST_F(FirstImportTest, AllMistakesOfASkinAreNamedTogether) {
  Skin(R"({"rows": 2, "columns": 0, "pitch": 1, "masked_taxels": [1]})");
  EXPECT_THAT(std::string(Import().status.message()),
              AllOf(HasSubstr("has 7 mistakes"), HasSubstr("name: is missing"),
                    HasSubstr("row_pitch_m: is missing"),
                    HasSubstr("column_pitch_m: is missing"),
                    HasSubstr("columns: is 0"), HasSubstr("unit: is missing"),
                    HasSubstr("contact_threshold: is missing"),
                    HasSubstr("pitch: is not known")));
}

TEST_F(FirstImportTest, ASkinThatRestsAboveItsThresholdIsRemarkedUpon) {
  const std::string shape =
      R"({"name": "pad", "rows": 2, "columns": 3, "row_pitch_m": 0.01,
          "column_pitch_m": 0.01, "unit": "counts", "sample_rate_hz": 100,)";
  Skin(shape + R"("contact_threshold": 4})");
  Said said = Import();
  EXPECT_TRUE(said.status.ok()) << said.status;
  EXPECT_THAT(said.remarks,
              AllOf(HasSubstr("4 of 4 trials begin with half of the taxels"),
                    HasSubstr("median 100, contact_threshold 4")));
  // The advice works.
  Skin(shape + R"("contact_threshold": 4, "idle_frames": 1,
                  "baseline": "from idle frames",
                  "negative_values": "zero"})");
  said = Import();
  EXPECT_TRUE(said.status.ok()) << said.status;
  EXPECT_THAT(said.remarks, Not(HasSubstr("begin with half")));
}

}  // namespace
}  // namespace tactus::internal
