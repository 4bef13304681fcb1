#include "client/drivers/calibration/calibration_json.h"

#include "absl/strings/str_replace.h"
#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/flat_layout.h"

namespace tactus::internal::client {
namespace {

using ::testing::HasSubstr;

Calibration SmallCalibration() {
  Calibration made;
  made.device = "serial \"palm\" \\ é";
  made.layout = tactus::internal::testing::FlatLayout(
      "small", 1, 3, TaxelUnit::kCounts, 10, 15);
  made.created_ms = 1'790'000'000'123;
  made.frames = 300;
  made.sample_rate_hz = 29.97;
  made.baseline = {50.1, -0.1, 1.0 / 3};
  made.deviation = {2, 0, 5e-324};
  made.contact_threshold = {9, 0, 7.7};
  made.onset_threshold = {12, 0, 9.9};
  made.gains = {*GainCurve::Make({{0.1, 0.3}, {2, 7}}), std::nullopt,
                *GainCurve::Make({{3, 1}})};
  made.faults = {.dead = {1}, .stuck = {}, .noisy = {0, 2}};
  return made;
}

// A calibration of three axes, with one matrix for all taxels or for the last
// one only.
Calibration ThreeAxisCalibration(bool one_matrix) {
  Calibration made = SmallCalibration();
  made.layout.axes = 3;
  made.layout.normal_axis = 2;
  made.layout.signed_values = true;
  made.baseline = {50.1, -0.1, 1.0 / 3, -70, 1e-300, 7, 8, 9, 10};
  made.deviation = {2, 0, 5e-324, 3, 4, 5, 6, 7, 8};
  made.gains.clear();
  made.faults = {.dead = {1}, .stuck = {}, .noisy = {0}};
  const CrossAxis matrix = {
      {{{0.1, -1.0 / 3, 2e-5}, {-0.0, 1e11, 5e-324}, {3, 1e-3, -7.7}}}};
  made.cross_axis = {matrix};
  if (!one_matrix) made.cross_axis = {std::nullopt, std::nullopt, matrix};
  return made;
}

TEST(CalibrationJsonTest, ComesBackWithTheSameBits) {
  for (const Calibration& made :
       {SmallCalibration(), ThreeAxisCalibration(true),
        ThreeAxisCalibration(false)}) {
    const std::string text = CalibrationToJson(made);
    const auto again = CalibrationFromJson(text);
    ASSERT_TRUE(again.ok()) << again.status();
    EXPECT_EQ(*again, made);
    EXPECT_EQ(CalibrationToJson(*again), text);
  }
}

// As they were written before skins of three axes could be calibrated.
TEST(CalibrationJsonTest, FilesWithoutCrossAxisAreRead) {
  const std::string old = R"({
"format": "tactus-calibration",
"version": 1,
"device": "serial \"left\"",
"layout": {"layout":"s","rows":2,"columns":2,"row_pitch_m":0.01,"column_pitch_m":0.01,"taxel_area_m2":0.0001,"unit":"TAXEL_UNIT_COUNTS","contact_threshold":10,"onset_threshold":20,"connectivity":"CONNECTIVITY_8"},
"created_ms": 0,
"frames": 100,
"sample_rate_hz": 30,
"baseline": [1,2.5,0,0.001],
"deviation": [1,0,2,1],
"contact_threshold": [3,3,3,3],
"onset_threshold": [4,4,4,5.5],
"gains": [null,null,[[1,0.5],[3,7]],null],
"dead": [1],
"stuck": [],
"noisy": [2]
}
)";
  const auto read = CalibrationFromJson(old);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_TRUE(read->cross_axis.empty());
  EXPECT_EQ(read->baseline, (std::vector<double>{1, 2.5, 0, 1e-3}));
  EXPECT_EQ(read->gains[2]->Load(3), 7);
  EXPECT_EQ(CalibrationToJson(*read), old);
}

TEST(CalibrationJsonTest, EachFaultOfThreeAxesIsNamed) {
  const std::string good = CalibrationToJson(ThreeAxisCalibration(false));
  const struct {
    const char* part;
    const char* instead;
    const char* named;
  } cases[] = {
      {"\"baseline\": [50", "\"baseline\": [1,50",
       "numbers of baseline is 10; it must be 9, one per taxel and axis"},
      {"\"deviation\": [2,", "\"deviation\": [", "numbers of deviation is 8"},
      {"\"gains\": []", "\"gains\": [null,null,null]",
       "gains is given for three axes"},
      {"[3,", "[", "cross_axis is another list; it must be 3 rows of 3"},
      {"[3,", "[3,4,", "cross_axis"},
      {"[3,", "[null,", "cross_axis"},
      {"[null,null,", "[null,null,3,",
       "cross_axis is number; it must be a list"},
      {"[null,null,", "[null,",
       "matrices of cross_axis is 2; it must be none, 1 or 3"},
      {"[null,null,[[", "[null,null,[[1,2,3],[", "cross_axis"},
      {"[3,", "[1e300,",
       "cross_axis of taxel 2, load_z per reading_x is 1e+300"},
      {"\"dead\": [1]", "\"dead\": []", "cross_axis of taxel 1 is absent"},
      {"\"axes\":3", "\"axes\":2", "axes"},
  };
  for (const auto& c : cases) {
    const std::string text = absl::StrReplaceAll(good, {{c.part, c.instead}});
    ASSERT_NE(text, good) << c.part << good;
    const auto read = CalibrationFromJson(text);
    EXPECT_EQ(ReasonOf(read.status()), "INVALID_CONFIG") << c.instead;
    EXPECT_THAT(read.status().message(), HasSubstr(c.named)) << c.instead;
  }
}

TEST(CalibrationJsonTest, BracketsInTextAreNotNested) {
  Calibration made = SmallCalibration();
  made.device =
      absl::StrCat(std::string(50, '['), "\\\"", std::string(50, '{'));
  const auto again = CalibrationFromJson(CalibrationToJson(made));
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(*again, made);
}

TEST(CalibrationJsonTest, EachFaultIsNamed) {
  const std::string good = CalibrationToJson(SmallCalibration());
  const struct {
    const char* part;
    const char* instead;
    const char* named;
  } cases[] = {
      {"tactus-calibration", "other", "format"},
      {"\"version\": 1", "\"version\": 2", "version"},
      {"\"frames\": 300", "\"frames\": 0", "frames"},
      {"\"frames\": 300", "\"frames\": \"many\"", "frames"},
      {"\"device\"", "\"devise\"", "device"},
      {"[9,0,", "[9,", "contact_threshold"},
      {"[9,0,", "[9,-1,", "contact_threshold"},
      {"[9,0,", "[9,null,", "contact_threshold"},
      {"[9,0,", "[9,1e300,", "contact_threshold"},
      {"[12,0,", "[12,0,0,", "onset_threshold"},
      {"\"deviation\": [2,", "\"deviation\": [-2,", "deviation"},
      {"[50.1", "{\"x\":50.1", "calibration"},
      {"\"dead\": [1]", "\"dead\": [3]", "dead"},
      {"\"dead\": [1]", "\"dead\": [-1]", "dead"},
      {"\"dead\": [1]", "\"dead\": [99999999999]", "dead"},
      {"\"noisy\": [0,2]", "\"noisy\": [2,0]", "noisy"},
      {"[2,7]", "[2,0.1]", "gain curve"},
      {"[2,7]", "[2]", "gains"},
      {",null,", ",", "gains"},
      {"\"rows\":1", "\"rows\":0", "rows"},
  };
  for (const auto& c : cases) {
    const std::string text = absl::StrReplaceAll(good, {{c.part, c.instead}});
    ASSERT_NE(text, good) << c.part;
    const auto read = CalibrationFromJson(text);
    EXPECT_EQ(ReasonOf(read.status()), "INVALID_CONFIG") << c.instead;
    EXPECT_THAT(read.status().message(), HasSubstr(c.named)) << c.instead;
  }
  // A million brackets, in a part that is read and in one that is not.
  for (const char* part : {"\"rows\":1", "\"version\": 1"}) {
    const std::string deep = absl::StrReplaceAll(
        good, {{part, absl::StrCat("\"x\": ", std::string(1'000'000, '['),
                                   std::string(1'000'000, ']'), ",", part)}});
    const absl::Status status = CalibrationFromJson(deep).status();
    EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG");
    EXPECT_THAT(status.message(), HasSubstr("depth"));
  }
  for (const char* text : {"", "[]", "null", "{}", "{\"format\": 3}"}) {
    EXPECT_EQ(ReasonOf(CalibrationFromJson(text).status()), "INVALID_CONFIG")
        << text;
  }
}

}  // namespace
}  // namespace tactus::internal::client
