#include "core/data/trial_record.h"

#include <cmath>

#include "core/base/errors.h"
#include "core/skin/layout.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/data/trial_samples.h"

namespace tactus::internal {
namespace {

using testing::HasSubstr;

// A trial with every field set, on the skin of a preset.
Trial PresetTrial(uint64_t seed, int frames, bool floats) {
  Trial trial = FullTrial(seed, frames, floats);
  trial.id = "000042";
  SetSkin(*LayoutPreset("icub-6x10"), trial);
  trial.taxels.rows = 6;
  trial.taxels.columns = 10;
  trial.taxels.u16.clear();
  trial.taxels.f32.clear();
  Random random(seed);
  for (int i = 0; i < 60 * frames; ++i) {
    if (floats) {
      trial.taxels.f32.push_back(static_cast<float>(random.Uniform()));
    } else {
      trial.taxels.u16.push_back(static_cast<uint16_t>(random.Index(65536)));
    }
  }
  return trial;
}

absl::StatusOr<Trial> ThereAndBack(const Trial& trial) {
  v1::TrialRecord record;
  EXPECT_TRUE(record.ParseFromString(ToRecord(trial).SerializeAsString()));
  return FromRecord(record);
}

TEST(TrialRecordTest, EveryBitComesBack) {
  for (const bool floats : {false, true}) {
    for (const int frames : {1, 2, 17}) {
      const Trial trial = PresetTrial(frames, frames, floats);
      const auto same = ThereAndBack(trial);
      ASSERT_TRUE(same.ok()) << same.status();
      EXPECT_TRUE(SameBits(trial, *same));
    }
  }
}

TEST(TrialRecordTest, TouchesComeBack) {
  Trial trial = TrialOfTouches(3, 9);
  trial.id = "000042";
  const auto same = ThereAndBack(trial);
  ASSERT_TRUE(same.ok()) << same.status();
  EXPECT_TRUE(SameBits(trial, *same));
  v1::TrialRecord record = ToRecord(trial);
  EXPECT_EQ(record.touches(1).label(), "egg");
  EXPECT_FALSE(record.touches(1).has_row());
  EXPECT_EQ(record.touches(0).column(), 2.7);
  record.mutable_touches(1)->set_row(1);
  const absl::Status half = FromRecord(record).status();
  EXPECT_EQ(ReasonOf(half), "INVALID_TRIAL");
  EXPECT_THAT(std::string(half.message()),
              HasSubstr("trial 000042: touches: 1: has a row or a column"));
}

TEST(TrialRecordTest, PartsMayBeAbsent) {
  Trial bare;
  bare.id = "a";
  bare.time = {0, 0.5};
  bare.signals = {{1, 2, 3}, {-0.0, 5e-324, 1e16}};
  auto same = ThereAndBack(bare);
  ASSERT_TRUE(same.ok()) << same.status();
  EXPECT_TRUE(SameBits(bare, *same));
  EXPECT_TRUE(std::signbit(same->signals[1][0]));

  Trial taxels = PresetTrial(3, 4, false);
  taxels.signals.clear();
  taxels.poses.clear();
  taxels.object_motion.clear();
  same = ThereAndBack(taxels);
  ASSERT_TRUE(same.ok()) << same.status();
  EXPECT_TRUE(SameBits(taxels, *same));
}

// The contract's numbers, read by hand.
TEST(TrialRecordTest, FieldsAreWhatTheContractSays) {
  Trial trial = PresetTrial(5, 2, false);
  trial.taxels.u16[61] = 0x1234;
  trial.poses[1].orientation.coeffs() = Eigen::Vector4d(0, 0, 0.6, 0.8);
  const v1::TrialRecord record = ToRecord(trial);
  EXPECT_EQ(record.taxels().size(), 240u);
  EXPECT_EQ(record.taxels()[122], 0x34);
  EXPECT_EQ(record.taxels()[123], 0x12);
  EXPECT_EQ(record.poses(7 + 5), 0.6);
  EXPECT_EQ(record.poses(7 + 6), 0.8);
  EXPECT_EQ(record.signals(4), trial.signals[1][1]);
  EXPECT_EQ(record.geometry().layout(), "icub-6x10");
  EXPECT_EQ(record.geometry().contact_threshold(),
            LayoutPreset("icub-6x10")->contact_threshold);
  EXPECT_EQ(record.unit(), v1::TAXEL_UNIT_COUNTS);
}

TEST(TrialRecordTest, ASkinThatIsNoPresetComesBack) {
  Trial trial = FullTrial(1, 3);
  trial.id = "000042";
  const v1::TrialRecord record = ToRecord(trial);
  EXPECT_EQ(record.geometry().layout(), "test-3x4");
  EXPECT_EQ(record.geometry().row_pitch_m(), 0.1 / 3);
  EXPECT_THAT(record.geometry().masked_taxels(), testing::ElementsAre(5));
  const auto same = ThereAndBack(trial);
  ASSERT_TRUE(same.ok()) << same.status();
  EXPECT_TRUE(SameBits(trial, *same));
}

// A preset with another threshold is a skin like any other.
TEST(TrialRecordTest, AChangedPresetComesBack) {
  Trial trial = PresetTrial(2, 3, false);
  trial.skin->onset_threshold *= 2;
  const auto same = ThereAndBack(trial);
  ASSERT_TRUE(same.ok()) << same.status();
  EXPECT_TRUE(SameBits(trial, *same));
}

TEST(TrialRecordTest, TheNameOfAPresetIsEnough) {
  const Trial whole = PresetTrial(4, 3, true);
  Trial named = whole;
  named.skin.reset();
  EXPECT_EQ(ToRecord(named).SerializeAsString(),
            ToRecord(whole).SerializeAsString());
  const auto same = ThereAndBack(named);
  ASSERT_TRUE(same.ok()) << same.status();
  EXPECT_TRUE(SameBits(whole, *same));
}

TEST(TrialRecordTest, ASkinThatIsNotKnownIsRefused) {
  Trial trial = FullTrial(1, 3);
  trial.id = "000042";
  trial.skin.reset();
  const auto refused = ThereAndBack(trial);
  EXPECT_EQ(ReasonOf(refused.status()), "INVALID_TRIAL");
  EXPECT_THAT(std::string(refused.status().message()),
              HasSubstr("trial 000042: geometry: "));
}

struct BadRecord {
  const char* text;
  void (*spoil)(v1::TrialRecord&);
};

class BadRecordTest : public testing::TestWithParam<BadRecord> {};

TEST_P(BadRecordTest, NamesTrialAndField) {
  v1::TrialRecord record = ToRecord(PresetTrial(7, 4, false));
  ASSERT_TRUE(FromRecord(record).ok());
  GetParam().spoil(record);
  const absl::Status status = FromRecord(record).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(ReasonOf(status), "INVALID_TRIAL");
  EXPECT_THAT(std::string(status.message()), testing::StartsWith("trial "));
  EXPECT_THAT(std::string(status.message()), HasSubstr(GetParam().text));
}

using Record = v1::TrialRecord;

INSTANTIATE_TEST_SUITE_P(
    All, BadRecordTest,
    testing::Values(
        BadRecord{"id: is empty", [](Record& r) { r.clear_id(); }},
        BadRecord{"id: has 257 bytes",
                  [](Record& r) { r.set_id(std::string(257, 'x')); }},
        BadRecord{"id: ", [](Record& r) { r.set_id("a\nb"); }},
        BadRecord{"000042: label: has 300",
                  [](Record& r) { r.set_label(std::string(300, 'x')); }},
        BadRecord{"000042: object: ", [](Record& r) { r.set_object("\x7f"); }},
        BadRecord{"time: has 0 entries", [](Record& r) { r.clear_time(); }},
        BadRecord{"time: entry 2 is",
                  [](Record& r) { r.set_time(2, r.time(1)); }},
        BadRecord{"time: entry 1 is nan",
                  [](Record& r) { r.set_time(1, NAN); }},
        BadRecord{"signals: has 11 numbers; it must have 3 per time, 12",
                  [](Record& r) { r.mutable_signals()->RemoveLast(); }},
        BadRecord{"signals: area of row 3",
                  [](Record& r) { r.set_signals(10, NAN); }},
        BadRecord{"signals: missing",
                  [](Record& r) {
                    r.clear_signals();
                    r.clear_taxels();
                    r.clear_geometry();
                  }},
        BadRecord{"poses: has 29 numbers", [](Record& r) { r.add_poses(0); }},
        BadRecord{"pose: position of row 1",
                  [](Record& r) { r.set_poses(8, 2e6); }},
        BadRecord{"pose: quaternion of row 2",
                  [](Record& r) { r.set_poses(20, NAN); }},
        BadRecord{"object_motion: has 5 numbers",
                  [](Record& r) { r.add_object_motion(0); }},
        BadRecord{"object_motion: entry 3",
                  [](Record& r) { r.set_object_motion(3, -2e6); }},
        BadRecord{"unit: is 0", [](Record& r) { r.clear_unit(); }},
        BadRecord{"unit: is newton; that of the geometry is counts",
                  [](Record& r) { r.set_unit(v1::TAXEL_UNIT_NEWTON); }},
        BadRecord{"geometry: is missing",
                  [](Record& r) { r.clear_geometry(); }},
        BadRecord{"geometry: is given without taxels",
                  [](Record& r) { r.clear_taxels(); }},
        BadRecord{"geometry: ",
                  [](Record& r) { r.mutable_geometry()->set_rows(65); }},
        BadRecord{
            "geometry: geometry.onset_threshold",
            [](Record& r) { r.mutable_geometry()->set_onset_threshold(1); }},
        BadRecord{
            "geometry: geometry.masked_taxels",
            [](Record& r) { r.mutable_geometry()->add_masked_taxels(60); }},
        BadRecord{"geometry: geometry.unit",
                  [](Record& r) { r.mutable_geometry()->clear_unit(); }},
        BadRecord{"taxel_type: is 0", [](Record& r) { r.clear_taxel_type(); }},
        BadRecord{"taxels: has 480 bytes; it must have one frame of 6 x 10 "
                  "values per time, 960 bytes",
                  [](Record& r) {
                    r.set_taxel_type(v1::TAXEL_TYPE_FLOAT32);
                    r.clear_scale();
                  }},
        BadRecord{"taxels: has 479 bytes",
                  [](Record& r) { r.mutable_taxels()->pop_back(); }},
        BadRecord{"scale: is 2; it must be 0",
                  [](Record& r) {
                    r.set_taxel_type(v1::TAXEL_TYPE_FLOAT32);
                    r.set_taxels(std::string(960, '\0'));
                    r.set_scale(2);
                  }},
        BadRecord{"taxels: scale is 0", [](Record& r) { r.clear_scale(); }},
        BadRecord{"taxels: taxel 0 of frame 0 is -",
                  [](Record& r) {
                    r.set_taxel_type(v1::TAXEL_TYPE_FLOAT32);
                    r.set_taxels(std::string(960, '\xbf'));
                    r.clear_scale();
                  }},
        BadRecord{"stiffness: is -1", [](Record& r) { r.set_stiffness(-1); }},
        BadRecord{"velocity: is nan", [](Record& r) { r.set_velocity(NAN); }},
        BadRecord{"sample_rate_hz: is 0",
                  [](Record& r) { r.clear_sample_rate_hz(); }}));

}  // namespace
}  // namespace tactus::internal
