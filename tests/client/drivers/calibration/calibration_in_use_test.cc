// What a recording keeps of a calibration, as text and back.
#include "client/drivers/calibration/calibration_in_use.h"

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal::client {
namespace {

CalibrationInUse InUseSample() {
  CalibrationInUse in_use{.device = "serial \"left\" palm",
                          .tare = {0.1, 1.0 / 3, 7, 1e-300},
                          .drift_time_s = 0.3};
  in_use.calibration.emplace();
  Calibration& made = *in_use.calibration;
  made.device = "left";
  made.layout = *LayoutPreset("vitac-12x32");
  made.layout.rows = 2;
  made.layout.columns = 2;
  made.frames = 10;
  made.baseline = {1, 2, 3, 0.1};
  made.deviation = {1, 1, 1, 1};
  made.contact_threshold = {3, 3, 3, 3};
  made.onset_threshold = {4, 4, 4, 4};
  made.gains.resize(4);
  made.gains[2] = *GainCurve::Make({{1, 0.1}, {2, 5}});
  made.faults.stuck = {1};
  return in_use;
}

TEST(CalibrationInUseTest, ComesBackWithTheSameBits) {
  CalibrationInUse in_use = InUseSample();
  auto again = CalibrationInUseFromJson(ToJson(in_use));
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(*again, in_use);
  in_use.calibration.reset();
  again = CalibrationInUseFromJson(ToJson(in_use));
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(*again, in_use);
}

TEST(CalibrationInUseTest, ThreeAxesComeBackWithTheSameBits) {
  CalibrationInUse in_use = InUseSample();
  Calibration& made = *in_use.calibration;
  made.layout.axes = 3;
  made.layout.signed_values = true;
  made.baseline = {1, 2, 3, 0.1, -4, -5, -1.0 / 3, 7, 8, 9, 10, 11};
  made.deviation.assign(12, 1.0 / 3);
  made.gains.clear();
  made.cross_axis = {
      CrossAxis{{{{0.1, 1.0 / 3, -5}, {4, 1e-300, 6}, {7, 8, 9}}}}};
  in_use.tare = made.baseline;
  const auto again = CalibrationInUseFromJson(ToJson(in_use));
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(*again, in_use);
  // A tare of one axis is not one of three.
  in_use.tare.resize(4);
  EXPECT_THAT(
      std::string(CalibrationInUseFromJson(ToJson(in_use)).status().message()),
      ::testing::HasSubstr("numbers of tare is 4; it must be 12"));
}

TEST(CalibrationInUseTest, EveryMistakeIsNamed) {
  const std::string good = ToJson(InUseSample());
  const std::tuple<const char*, const char*, const char*> changes[] = {
      {"\"format\":\"tactus-calibration-in-use\"", "\"format\":\"x\"",
       "format and version"},
      {"\"device\":\"serial \\\"left\\\" palm\"", "\"device\":3", "device"},
      {"\"drift_s\":0.3", "\"drift_s\":-1", "drift_s"},
      {"\"drift_s\":0.3", "\"drift\":1", "drift_s"},
      {"\"tare\":[0.1,", "\"tare\":[null,", "tare"},
      {"\"tare\":[0.1,", "\"tare\":[", "numbers of tare"},
      {"\"baseline\":[1,", "\"baseline\":[", "baseline"},
  };
  for (const auto& [from, to, name] : changes) {
    std::string bad = good;
    const size_t at = bad.find(from);
    ASSERT_NE(at, std::string::npos) << from << " in " << good;
    bad.replace(at, std::string(from).size(), to);
    const absl::Status status = CalibrationInUseFromJson(bad).status();
    EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG") << to;
    EXPECT_THAT(std::string(status.message()), ::testing::HasSubstr(name));
  }
  for (const char* text : {"", "[]", "{", "null"}) {
    EXPECT_EQ(ReasonOf(CalibrationInUseFromJson(text).status()),
              "INVALID_CONFIG");
  }
}

}  // namespace
}  // namespace tactus::internal::client
