// Trials of three axes and of signed values, in each file format.
#include "core/base/errors.h"
#include "core/data/frame_fingerprint.h"
#include "core/data/trial_csv.h"
#include "core/data/trial_file.h"
#include "core/data/trial_layout.h"
#include "core/data/trial_loads.h"
#include "core/data/trial_npz.h"
#include "core/data/trial_record.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/data/trial_samples.h"

namespace tactus::internal {
namespace {

using testing::HasSubstr;

constexpr v1::TaxelType kTypes[] = {v1::TAXEL_TYPE_UINT16, v1::TAXEL_TYPE_INT16,
                                    v1::TAXEL_TYPE_FLOAT32};

TEST(AxesTrialTest, ComesBackFromEachFormatBitForBit) {
  const ScratchDir dir;
  for (const v1::TaxelType type : kTypes) {
    Trial trial = TrialOfAxes(3, 17, type);
    ASSERT_TRUE(Validate(trial, "x").ok()) << Validate(trial, "x");
    EXPECT_EQ(trial.taxels.type(), type);
    EXPECT_EQ(trial.taxels.frames(), 17u);

    auto npz = TrialFromNpz("x.npz", *TrialToNpz(trial));
    ASSERT_TRUE(npz.ok()) << npz.status();
    EXPECT_TRUE(SameBits(trial, *npz));

    const std::string path = dir / (std::to_string(type) + ".h5");
    auto writer = TrialFileWriter::Create(path, {});
    ASSERT_TRUE(writer->Append(trial).ok());
    ASSERT_TRUE(writer->Close().ok());
    trial.id = "000000";
    const auto file = TrialFileReader::Open(path)->Read(0);
    ASSERT_TRUE(file.ok()) << file.status();
    EXPECT_TRUE(SameBits(trial, *file));

    const auto record = FromRecord(ToRecord(trial));
    ASSERT_TRUE(record.ok()) << record.status();
    EXPECT_TRUE(SameBits(trial, *record));
  }
}

TEST(AxesTrialTest, FramesAreDecodedTaxelByTaxel) {
  const Trial trial = TrialOfAxes(5, 4, v1::TAXEL_TYPE_INT16);
  TrialLoads loads(trial.taxels, *trial.skin);
  for (size_t t = 0; t < 4; ++t) {
    const std::span<const float> frame = loads.Frame(t);
    ASSERT_EQ(frame.size(), 12u);
    ASSERT_EQ(loads.values().size(), 36u);
    for (size_t i = 0; i < 36; ++i) {
      EXPECT_EQ(loads.values()[i], 0.5F * trial.taxels.i16[36 * t + i]);
    }
    for (size_t i = 0; i < 12; ++i) {
      EXPECT_EQ(frame[i], std::max(loads.values()[3 * i + 2], 0.0F));
    }
  }
}

TEST(AxesTrialTest, CsvNamesTheAxes) {
  Trial trial = TrialOfAxes(1, 2, v1::TAXEL_TYPE_INT16);
  trial.poses.clear();
  const std::vector<size_t> places = {0, 1, 2, 3, 35};
  const auto table = FramesToCsv(trial, places);
  ASSERT_TRUE(table.ok()) << table.status();
  EXPECT_THAT(*table, HasSubstr("time,r0c0x,r0c0y,r0c0z,r0c1x,r2c3z\n"));
}

TEST(AxesTrialTest, OtherAxesAreAnotherRecording) {
  const Trial trial = TrialOfAxes(1, 3, v1::TAXEL_TYPE_FLOAT32);
  Trial wide = trial;
  wide.taxels.axes = wide.skin->axes = 1;
  wide.skin->normal_axis.reset();
  wide.taxels.columns = wide.skin->columns = 12;
  wide.skin->mask.clear();
  ASSERT_TRUE(Validate(wide, "x").ok()) << Validate(wide, "x");
  EXPECT_NE(FrameFingerprint(trial), FrameFingerprint(wide));
}

struct BadAxes {
  const char* what;
  void (*change)(Trial& trial);
};

TEST(AxesTrialTest, RefusesWhatDoesNotFit) {
  const BadAxes table[] = {
      {"a taxel has 1 values; the skin has 3 axes",
       [](Trial& t) { t.taxels.axes = 1; }},
      {"a taxel has 3 values; the skin has 1 axes",
       [](Trial& t) {
         t.skin->axes = 1;
         t.skin->normal_axis.reset();
       }},
      {"a taxel has 3 values; the skin has 1 axes",
       [](Trial& t) { t.skin.reset(); }},
      {"has 35 values", [](Trial& t) { t.taxels.f32.resize(35); }},
      {"; it must be 0 to 1e12",
       [](Trial& t) { t.skin->signed_values = false; }},
      {"taxel 2 of frame 0 is -2e+12; it must be -1e12 to 1e12",
       [](Trial& t) { t.taxels.f32[7] = -2e12F; }},
      {"are int16; only a skin with signed_values",
       [](Trial& t) {
         t = TrialOfAxes(1, 1, v1::TAXEL_TYPE_INT16);
         t.skin->signed_values = false;
       }},
      {"geometry.normal_axis", [](Trial& t) { t.skin->normal_axis = 3; }},
  };
  for (const BadAxes& bad : table) {
    Trial trial = TrialOfAxes(1, 1, v1::TAXEL_TYPE_FLOAT32);
    bad.change(trial);
    const absl::Status status = Validate(trial, "x");
    EXPECT_EQ(ReasonOf(status), "TRIAL_FILE_INVALID") << bad.what;
    EXPECT_THAT(std::string(status.message()), HasSubstr(bad.what));
  }
  // A layout of another number of axes is not that of the trial.
  Trial trial = TrialOfAxes(1, 1, v1::TAXEL_TYPE_FLOAT32);
  SkinLayout given = *trial.skin;
  given.axes = 1;
  given.normal_axis.reset();
  trial.skin.reset();
  const absl::Status status = LayoutOfTrial(trial, &given).status();
  EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG");
  EXPECT_THAT(std::string(status.message()), HasSubstr("3x4x3"));
}

}  // namespace
}  // namespace tactus::internal
