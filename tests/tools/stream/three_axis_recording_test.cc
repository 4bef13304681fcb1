// A calibrated skin of three axes, recorded, replayed, and calibrated again
// with other matrices.
#include "client/drivers/recording_driver.h"
#include "client/recording/recorder.h"
#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/calibration/three_axis_skin.h"
#include "tests/support/scratch_dir.h"
#include "tools/stream/record_replay.h"

namespace tactus::internal::client {
namespace {

using testing::ThreeAxisSkin;

constexpr int kRecordedFrames = 150;

// Taxel 9 is pressed and pulled in the last third.
std::unique_ptr<ThreeAxisSkin> PulledSkin() {
  auto skin = std::make_unique<ThreeAxisSkin>(
      testing::SyntheticShape{.frames = 50 + kRecordedFrames});
  skin->newtons = [](int64_t frame, size_t taxel) {
    return taxel == 9 && frame >= 150 ? AxisVector{0.5, -0.5, 2} : AxisVector{};
  };
  return skin;
}

// All loads, in a recording's bytes, of a driver until its end.
std::vector<std::vector<float>> LoadsOf(CalibratedDriver& driver) {
  std::vector<std::vector<float>> loads;
  const auto info = driver.Configure();
  EXPECT_TRUE(info.ok()) << info.status();
  const absl::Status active = driver.Activate();
  EXPECT_TRUE(active.ok()) << active;
  SkinFrame frame;
  while (*driver.Read(frame) == ReadResult::kFrame) loads.push_back(frame.f32);
  return loads;
}

TEST(ThreeAxisRecordingTest, IsReplayedAndCalibratedAgain) {
  const ScratchDir folder;
  ThreeAxisSkin idle({.seed = 7});
  const auto made = Calibrate(testing::ReadIdle(idle, 200),
                              {.device = "palm", .cross_axis = idle.Truths()});
  ASSERT_TRUE(made.ok()) << made.status();
  const auto skin = PulledSkin();
  std::vector<std::vector<float>> loads;
  std::vector<std::vector<int16_t>> sent;
  {
    CalibratedDriver driver(skin.get(), {.device = "palm",
                                         .calibration = *made,
                                         .tare_frames = 50,
                                         .drift_time_s = 9});
    const auto info = driver.Configure();
    ASSERT_TRUE(info.ok()) << info.status();
    const auto recorder = *Recorder::Create(
        folder / "a.mcap",
        {.about = {{"stream", "skin"}, {"device", "palm"}}, .sync = false});
    recorder->Begin(*info, MakeConfig(*info), {});
    ASSERT_TRUE(driver.Activate().ok());
    recorder->BeginRaw(driver.raw_info(), ToJson(driver.in_use()));
    recorder->BeginTrial({{"label", "HU"}});
    SkinFrame frame;
    while (*driver.Read(frame) == ReadResult::kFrame) {
      recorder->Frame(frame, &driver.raw());
      loads.push_back(frame.f32);
      sent.push_back(driver.raw().i16);
    }
    recorder->EndTrial();
    const absl::Status finished = recorder->Finish();
    ASSERT_TRUE(finished.ok()) << finished;
  }
  ASSERT_EQ(loads.size(), static_cast<size_t>(kRecordedFrames));
  EXPECT_NEAR(loads.back()[9 * 3 + 1], -0.5, 0.06);

  // Raw frames are what the skin sent.
  RecordingDriver raw(folder / "a.mcap", {.raw = true});
  const auto info = raw.Configure();
  ASSERT_TRUE(info.ok()) << info.status();
  EXPECT_EQ(info->layout, skin->info.layout);
  EXPECT_EQ(info->taxel_type, v1::TAXEL_TYPE_INT16);
  ASSERT_TRUE(raw.Activate().ok());
  SkinFrame frame;
  for (const auto& numbers : sent) {
    ASSERT_EQ(*raw.Read(frame), ReadResult::kFrame);
    ASSERT_EQ(frame.i16, numbers);
  }

  const auto start = ReadRecordingStart(folder / "a.mcap");
  ASSERT_TRUE(start.ok()) << start.status();
  ASSERT_TRUE(start->calibration);
  EXPECT_EQ(start->calibration->calibration, *made);
  EXPECT_EQ(start->calibration->tare.size(), 96U);
  // The same calibration makes the same loads; twice the matrix twice the
  // loads, where they are above the thresholds.
  Calibration doubled = *made;
  for (auto& matrix : doubled.cross_axis) {
    for (AxisVector& row : matrix->rows) {
      for (double& element : row) element *= 2;
    }
  }
  for (double& threshold : doubled.contact_threshold) threshold *= 2;
  for (const bool twice : {false, true}) {
    RecordingDriver recording(folder / "a.mcap", {.raw = true});
    CalibratedDriver driver(
        &recording,
        Recalibration(*start, {.calibration = twice ? doubled : *made}));
    const auto again = LoadsOf(driver);
    ASSERT_EQ(again.size(), loads.size());
    for (size_t t = 0; t < loads.size(); ++t) {
      for (size_t i = 0; i < loads[t].size(); ++i) {
        ASSERT_EQ(again[t][i], (twice ? 2 : 1) * loads[t][i]) << t << " " << i;
      }
    }
  }
}

}  // namespace
}  // namespace tactus::internal::client
