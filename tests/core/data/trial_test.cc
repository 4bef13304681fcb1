#include "core/data/trial.h"

#include <cmath>
#include <limits>

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/data/trial_samples.h"

namespace tactus::internal {
namespace {

using testing::HasSubstr;

TEST(TaxelSeriesTest, DecodeGivesTheUnit) {
  TaxelSeries series;
  series.rows = 1;
  series.columns = 2;
  series.scale = 0.5;
  series.u16 = {0, 1, 400, 65535};
  ASSERT_EQ(series.frames(), 2u);
  float frame[2];
  series.Decode(0, frame);
  EXPECT_EQ(frame[0], 0.0F);
  EXPECT_EQ(frame[1], 0.5F);
  series.Decode(1, frame);
  EXPECT_EQ(frame[0], 200.0F);
  EXPECT_EQ(frame[1], 32767.5F);
}

TEST(TaxelSeriesTest, FloatsComeAsTheyAre) {
  TaxelSeries series;
  series.rows = 2;
  series.columns = 1;
  series.f32 = {1, 2, 3, 0.1F};
  float frame[2];
  series.Decode(1, frame);
  EXPECT_EQ(frame[0], 3.0F);
  EXPECT_EQ(frame[1], 0.1F);
  EXPECT_EQ(TaxelSeries().frames(), 0u);
}

TEST(ValidateTrialTest, FullTrialsAreValid) {
  EXPECT_TRUE(Validate(FullTrial(1, 5), "x").ok());
  EXPECT_TRUE(Validate(FullTrial(1, 5, true), "x").ok());
  EXPECT_TRUE(Validate(TrialOfTouches(1, 5), "x").ok());
  Trial bare;
  bare.time = {0};
  bare.signals = {{0, 0, 0}};
  EXPECT_TRUE(Validate(bare, "x").ok());
}

struct BadTrial {
  const char* part;
  const char* text;
  void (*spoil)(Trial&);
};

class ValidateBadTrialTest : public testing::TestWithParam<BadTrial> {};

TEST_P(ValidateBadTrialTest, NamesFileTrialAndPart) {
  Trial trial = FullTrial(7, 4);
  trial.id = "000042";
  GetParam().spoil(trial);
  const absl::Status status = Validate(trial, "file.h5");
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(ReasonOf(status), "TRIAL_FILE_INVALID");
  EXPECT_THAT(std::string(status.message()),
              HasSubstr(std::string("file.h5: trial 000042: ") +
                        GetParam().part + ": "));
  EXPECT_THAT(std::string(status.message()), HasSubstr(GetParam().text));
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

INSTANTIATE_TEST_SUITE_P(
    All, ValidateBadTrialTest,
    testing::Values(
        BadTrial{"time", "has 0 entries", [](Trial& t) { t.time.clear(); }},
        BadTrial{"time", "entry 1", [](Trial& t) { t.time[1] = kNan; }},
        BadTrial{"time", "entry 2 is", [](Trial& t) { t.time[2] = t.time[1]; }},
        BadTrial{"signals", "one is needed",
                 [](Trial& t) {
                   t.signals.clear();
                   t.taxels = TaxelSeries();
                 }},
        BadTrial{"signals", "has 3 rows",
                 [](Trial& t) { t.signals.pop_back(); }},
        BadTrial{"signals", "area of row 3",
                 [](Trial& t) { t.signals[3][1] = kInf; }},
        BadTrial{"taxels", "65 x 4", [](Trial& t) { t.taxels.rows = 65; }},
        BadTrial{"taxels", "3 x 0", [](Trial& t) { t.taxels.columns = 0; }},
        BadTrial{"taxels", "2 types",
                 [](Trial& t) { t.taxels.f32.push_back(1); }},
        BadTrial{"taxels", "has 47 values",
                 [](Trial& t) { t.taxels.u16.pop_back(); }},
        BadTrial{"taxels", "scale", [](Trial& t) { t.taxels.scale = 0; }},
        BadTrial{"taxels", "scale", [](Trial& t) { t.taxels.scale = kNan; }},
        BadTrial{"taxels", "scale", [](Trial& t) { t.taxels.scale = 1e9; }},
        BadTrial{"taxels", "with float values",
                 [](Trial& t) {
                   t.taxels.u16.clear();
                   t.taxels.f32.assign(48, 1);
                 }},
        BadTrial{"taxels", "taxel 5 of frame 1 is nan",
                 [](Trial& t) {
                   t.taxels.u16.clear();
                   t.taxels.scale = 1;
                   t.taxels.f32.assign(48, 1);
                   t.taxels.f32[17] = std::nanf("");
                 }},
        BadTrial{"taxels", "is -1",
                 [](Trial& t) {
                   t.taxels.u16.clear();
                   t.taxels.scale = 1;
                   t.taxels.f32.assign(48, 1);
                   t.taxels.f32[17] = -1;
                 }},
        BadTrial{"pose", "has 3 rows", [](Trial& t) { t.poses.pop_back(); }},
        BadTrial{"pose", "position of row 1",
                 [](Trial& t) { t.poses[1].position.y() = kNan; }},
        BadTrial{"pose", "position of row 1",
                 [](Trial& t) { t.poses[1].position.y() = -2e6; }},
        BadTrial{"pose", "quaternion of row 2",
                 [](Trial& t) { t.poses[2].orientation.coeffs() *= 1.01; }},
        BadTrial{"pose", "quaternion of row 2",
                 [](Trial& t) { t.poses[2].orientation.w() = kNan; }},
        BadTrial{"unit", "\"psi\"", [](Trial& t) { t.unit = "psi"; }},
        BadTrial{"label", "300 bytes",
                 [](Trial& t) { t.label = std::string(300, 'x'); }},
        BadTrial{"object", "control character",
                 [](Trial& t) { t.object = std::string("a\0b", 3); }},
        BadTrial{"stiffness", "is -1", [](Trial& t) { t.stiffness = -1; }},
        BadTrial{"object_motion", "has 3 entries",
                 [](Trial& t) { t.object_motion.assign(3, 0); }},
        BadTrial{"object_motion", "entry 2 is nan",
                 [](Trial& t) {
                   t.object_motion = {0, 0, kNan, 0};
                 }},
        BadTrial{"object_motion", "entry 1 is -2e+06",
                 [](Trial& t) {
                   t.object_motion = {0, -2e6, 0, 0};
                 }},
        BadTrial{"velocity", "is nan", [](Trial& t) { t.velocity = kNan; }},
        BadTrial{"sample_rate_hz", "is 0",
                 [](Trial& t) { t.sample_rate_hz = 0; }},
        BadTrial{"sample_rate_hz", "is 20000",
                 [](Trial& t) { t.sample_rate_hz = 20000; }}));

class ValidateBadTouchTest : public testing::TestWithParam<BadTrial> {};

TEST_P(ValidateBadTouchTest, NamesTheTouchAndTheValue) {
  Trial trial = TrialOfTouches(7, 4);
  trial.id = "000042";
  GetParam().spoil(trial);
  const absl::Status status = Validate(trial, "file.h5");
  EXPECT_EQ(ReasonOf(status), "TRIAL_FILE_INVALID");
  EXPECT_THAT(std::string(status.message()),
              HasSubstr(std::string("file.h5: trial 000042: touches: ") +
                        GetParam().part));
  EXPECT_THAT(std::string(status.message()), HasSubstr(GetParam().text));
}

INSTANTIATE_TEST_SUITE_P(
    All, ValidateBadTouchTest,
    testing::Values(
        BadTrial{"0: begin_s", "is -1 s",
                 [](Trial& t) { t.touches[0].begin_s = -1; }},
        BadTrial{"1: begin_s", "before the begin of the touch before",
                 [](Trial& t) { t.touches[1].begin_s = t.time[0]; }},
        BadTrial{"1: begin_s", "is 9 s",
                 [](Trial& t) { t.touches[1].begin_s = 9; }},
        BadTrial{"1: end_s", "is 9 s",
                 [](Trial& t) { t.touches[1].end_s = 9; }},
        BadTrial{"1: end_s", "is nan",
                 [](Trial& t) { t.touches[1].end_s = kNan; }},
        BadTrial{"1: end_s", "it must be begin_s",
                 [](Trial& t) { t.touches[1].end_s = t.time[0]; }},
        BadTrial{"0: label", "\"SU\"; it must be the trial's, \"SM\"",
                 [](Trial& t) { t.touches[0].label = "SU"; }},
        BadTrial{"1: label", "300 bytes",
                 [](Trial& t) { t.touches[1].label = std::string(300, 'x'); }},
        BadTrial{"1: object", "control character",
                 [](Trial& t) { t.touches[1].object = "a\n"; }},
        BadTrial{"1: stiffness", "is -1",
                 [](Trial& t) { t.touches[1].stiffness = -1; }},
        BadTrial{"0: row", "is nan",
                 [](Trial& t) { t.touches[0].centre->row = kNan; }},
        BadTrial{"0: column", "is 65",
                 [](Trial& t) { t.touches[0].centre->column = 65; }},
        BadTrial{"0: object_motion", "has 4 entries; it must have",
                 [](Trial& t) { t.touches[0].object_motion.push_back(0); }},
        BadTrial{"0: entry 1 of object_motion", "is inf",
                 [](Trial& t) { t.touches[0].object_motion[1] = kInf; }},
        BadTrial{"the trial has an object_motion", "its own",
                 [](Trial& t) { t.object_motion.assign(4, 0); }},
        BadTrial{"there are 65", "at most 64",
                 [](Trial& t) { t.touches.resize(65, t.touches[0]); }}));

}  // namespace
}  // namespace tactus::internal
