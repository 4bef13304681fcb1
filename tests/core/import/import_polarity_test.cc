// Events with a polarity become two planes of taxels.
#include "core/base/errors.h"
#include "core/features/skin_tracker.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/import/import_all.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal {
namespace {

using ::testing::HasSubstr;

// 2 x 3 taxels at 10 Hz.
class ImportPolarityTest : public ::testing::Test {
 protected:
  absl::StatusOr<Trial> Import(const std::string& more,
                               const std::string& events) {
    WriteBytes(dir_ / "skin.json", R"({"name": "mine", "rows": 2, "columns": 3,
                "row_pitch_m": 0.01, "column_pitch_m": 0.01,
                "unit": "counts", "contact_threshold": 1,
                "sample_rate_hz": 10, )" +
                                       more + "}");
    WriteBytes(dir_ / "trials.csv", "frames,label\na.csv,cork\n");
    WriteBytes(dir_ / "a.csv", events);
    auto trials = ImportAll(dir_.path());
    if (!trials.ok()) return trials.status();
    return trials->front();
  }

  const std::string planes_ = R"("events": "count", "polarity": "two planes")";
  // Two on and one off at taxel 4, one off at taxel 1.
  const std::string events_ =
      "time,taxel,value\n"
      "0.00,4,1\n0.01,4,0\n0.02,4,1\n0.03,1,-1\n0.15,0,1\n";
  const ScratchDir dir_;
};

TEST_F(ImportPolarityTest, OnAndOffAreCountedApart) {
  const auto trial = Import(planes_, events_);
  ASSERT_TRUE(trial.ok()) << trial.status();
  // Two rows, one that is masked, two rows.
  EXPECT_EQ(trial->skin->rows, 5);
  EXPECT_EQ(trial->skin->columns, 3);
  EXPECT_EQ(trial->skin->mask, (std::vector<uint8_t>{1, 1, 1, 1, 1, 1,  //
                                                     0, 0, 0,           //
                                                     1, 1, 1, 1, 1, 1}));
  EXPECT_EQ(trial->taxels.f32, (std::vector<float>{0, 0, 0, 0, 2, 0,  //
                                                   0, 0, 0,           //
                                                   0, 1, 0, 0, 1, 0,  //
                                                   1, 0, 0, 0, 0, 0,  //
                                                   0, 0, 0,           //
                                                   0, 0, 0, 0, 0, 0}));
  // The planes are no neighbours.
  SkinTracker tracker(*trial->skin, {});
  std::vector<float> frame(trial->taxels.f32.begin(),
                           trial->taxels.f32.begin() + 15);
  tracker.Step({.taxels = frame});
  EXPECT_EQ(tracker.regions(), 2);
}

TEST_F(ImportPolarityTest, SumsGoOnAndMasksHoldForBothPlanes) {
  const auto trial = Import(R"("events": "sum", "polarity": "two planes",
                "masked_taxels": [1])",
                            events_);
  ASSERT_TRUE(trial.ok()) << trial.status();
  EXPECT_EQ(trial->skin->mask[1], 0);
  EXPECT_EQ(trial->skin->mask[9 + 1], 0);
  const std::vector<float> last(trial->taxels.f32.end() - 15,
                                trial->taxels.f32.end());
  EXPECT_EQ(last, (std::vector<float>{1, 0, 0, 0, 2, 0,  //
                                      0, 0, 0,           //
                                      0, 0, 0, 0, 1, 0}));
}

TEST_F(ImportPolarityTest, RowsAreThoseOfOnePlane) {
  const auto trial =
      Import(planes_, "time,row,column,value\n0,1,2,0\n0.05,0,1,1\n");
  ASSERT_TRUE(trial.ok()) << trial.status();
  EXPECT_EQ(trial->taxels.f32[1], 1);
  EXPECT_EQ(trial->taxels.f32[3 * 3 + 5], 1);
  EXPECT_THAT(std::string(Import(planes_, "time,row,column,value\n0,2,0,0\n")
                              .status()
                              .message()),
              HasSubstr("must be a whole number from 0 to 1"));
  EXPECT_THAT(
      std::string(
          Import(planes_, "time,taxel,value\n0,6,1\n").status().message()),
      HasSubstr("must be a whole number from 0 to 5"));
}

TEST_F(ImportPolarityTest, NamesEachMistake) {
  const std::pair<std::string, const char*> table[] = {
      {R"("polarity": "two planes")", "polarity: needs \"events\""},
      {R"("polarity": "two planes", "events": "hold")",
       "polarity: needs \"events\""},
      {R"("polarity": "one", "events": "count")",
       "polarity: is \"one\"; it must be \"two planes\""},
  };
  for (const auto& [skin, what] : table) {
    const absl::Status status = Import(skin, events_).status();
    EXPECT_EQ(ReasonOf(status), "TRIAL_FILE_INVALID") << skin;
    EXPECT_THAT(std::string(status.message()), HasSubstr(what));
  }
  EXPECT_THAT(
      std::string(Import(planes_, "time,taxel\n0,1\n").status().message()),
      HasSubstr("has no value per event"));
}

}  // namespace
}  // namespace tactus::internal
