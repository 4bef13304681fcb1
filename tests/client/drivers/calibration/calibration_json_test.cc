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

TEST(CalibrationJsonTest, ComesBackWithTheSameBits) {
  const Calibration made = SmallCalibration();
  const std::string text = CalibrationToJson(made);
  const auto again = CalibrationFromJson(text);
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(*again, made);
  EXPECT_EQ(CalibrationToJson(*again), text);
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
