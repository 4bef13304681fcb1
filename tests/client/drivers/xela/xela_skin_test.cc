// A second kind of skin on the same buses and the same driver.
#include "client/drivers/xela/xela_skin.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "client/drivers/can_skin_driver.h"
#include "core/base/errors.h"
#include "core/features/skin_tracker.h"
#include "core/files/npy_write.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/memory_bus.h"
#include "tests/core/import/import_all.h"
#include "tests/support/scratch_dir.h"
#include "tools/fakeskin/xela_patch.h"

namespace tactus::internal::client {
namespace {

using ::testing::HasSubstr;

// Taxel 5 is pressed after 3 s.
void PressTaxel5(int64_t time_ns, std::span<double> counts) {
  if (time_ns <= 3'000'000'000) return;
  counts[3 * 5] = -120;
  counts[3 * 5 + 1] = 40;
  counts[3 * 5 + 2] = 700;
}

SkinLayout OneAxis() {
  SkinLayout layout = XelaLayout();
  layout.axes = 1;
  layout.normal_axis.reset();
  layout.signed_values = false;
  return layout;
}

// A layout of one axis gets Z alone.
TEST(XelaSkinTest, APatchStreamsThroughTheSameDriver) {
  ManualClock clock;
  XelaPatch patch(PressTaxel5);
  MemoryBus bus(&patch, &clock);
  XelaSkin skin({.board = 1, .layout = OneAxis()});
  CanSkinDriver driver(&bus, &skin, {}, &clock);
  const auto info = driver.Configure();
  ASSERT_TRUE(info.ok()) << info.status();
  EXPECT_EQ(info->layout.taxels(), 16);
  EXPECT_EQ(info->sample_rate_hz, 100);
  EXPECT_FALSE(patch.IsSending());
  ASSERT_TRUE(driver.Activate().ok());
  SkinFrame frame;
  int frames = 0;
  uint64_t missing = 0;
  int pressed = 0;
  while (clock.NowNs() < 4'000'000'000) {
    const auto result = driver.Read(frame);
    ASSERT_TRUE(result.ok()) << result.status();
    if (*result != ReadResult::kFrame) continue;
    ++frames;
    missing += frame.missing_before;
    for (int i = 0; i < 16; ++i) {
      EXPECT_TRUE(i == 5 || frame.u16[i] == 0) << i;
    }
    if (frame.u16[5] > 0) {
      ++pressed;
      EXPECT_EQ(frame.u16[5], 700);
    }
  }
  EXPECT_GT(frames, 200);
  EXPECT_NEAR(pressed, 100, 2);
  EXPECT_EQ(missing, 0u);
  EXPECT_TRUE(driver.Finalise().ok());
  EXPECT_FALSE(patch.IsSending());
}

// Reads all frames until `end_ns`.
std::vector<SkinFrame> FramesUntil(int64_t end_ns, ManualClock& clock,
                                   CanSkinDriver& driver) {
  std::vector<SkinFrame> frames;
  SkinFrame frame;
  while (clock.NowNs() < end_ns) {
    const auto result = driver.Read(frame);
    EXPECT_TRUE(result.ok()) << result.status();
    if (*result == ReadResult::kFrame) frames.push_back(frame);
  }
  return frames;
}

TEST(XelaSkinTest, AllAxesAreAboveTheUntouchedPatch) {
  ManualClock clock;
  XelaPatch patch(PressTaxel5);
  MemoryBus bus(&patch, &clock);
  XelaSkin skin({.board = 1});
  CanSkinDriver driver(&bus, &skin, {}, &clock);
  const auto info = driver.Configure();
  ASSERT_TRUE(info.ok()) << info.status();
  EXPECT_EQ(info->taxel_type, v1::TAXEL_TYPE_INT16);
  EXPECT_EQ(info->layout.values(), 48);
  ASSERT_TRUE(driver.Activate().ok());
  const auto frames = FramesUntil(4'000'000'000, clock, driver);
  ASSERT_GT(frames.size(), 200U);
  EXPECT_EQ(frames.front().i16, std::vector<int16_t>(48, 0));
  std::vector<int16_t> pressed(48, 0);
  pressed[15] = -120;
  pressed[16] = 40;
  pressed[17] = 700;
  EXPECT_EQ(frames.back().i16, pressed);
}

// The taxel that does not move is named by its place on the skin.
TEST(XelaSkinTest, AStuckTaxelIsFoundByItsLoad) {
  ManualClock clock;
  XelaPatch patch(PressTaxel5);
  MemoryBus bus(&patch, &clock);
  XelaSkin skin({.board = 1});
  CanSkinDriver driver(&bus, &skin, {}, &clock);
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  FramesUntil(300'000'000'000, clock, driver);
  EXPECT_EQ(driver.Statistics().stuck_taxels, std::vector<int>{5});
}

TEST(XelaSkinTest, RefusesOtherAxes) {
  ManualClock clock;
  XelaPatch patch(PressTaxel5);
  MemoryBus bus(&patch, &clock);
  SkinLayout layout = XelaLayout();
  layout.normal_axis = 0;
  XelaSkin skin({.board = 1, .layout = layout});
  const absl::Status status = skin.Setup(bus, clock).status();
  EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG");
  EXPECT_THAT(std::string(status.message()), HasSubstr("axes of the layout"));
}

// All numbers of a frame's contacts, as one list.
void AppendFeatures(const SkinTracker& tracker, std::vector<double>& all) {
  for (const TrackedContact* contact : tracker.contacts()) {
    const ContactSample sample = contact->features().sample();
    all.push_back(static_cast<double>(contact->id()));
    all.insert(all.end(), sample.features.begin(), sample.features.end());
    all.insert(all.end(),
               {sample.net_force, sample.spread.rows, sample.spread.columns,
                sample.shear.first, sample.shear.second});
  }
}

// What the driver makes of the bytes of a bus has the features of the same
// presses imported as an array.
TEST(XelaSkinTest, AStreamHasTheFeaturesOfTheArray) {
  ManualClock clock;
  XelaPatch patch(PressXela);
  MemoryBus bus(&patch, &clock);
  XelaSkin skin({.board = 1});
  CanSkinDriver driver(&bus, &skin, {}, &clock);
  const auto info = driver.Configure();
  ASSERT_TRUE(info.ok()) << info.status();
  ASSERT_TRUE(driver.Activate().ok());
  const auto frames = FramesUntil(20'000'000'000, clock, driver);

  std::vector<int16_t> array;
  for (const SkinFrame& frame : frames) {
    std::array<double, XelaPatch::kValues> counts = {};
    PressXela(frame.capture_time_ns, counts);
    for (const double count : counts) {
      array.push_back(static_cast<int16_t>(std::lround(count)));
    }
  }
  const ScratchDir dir;
  WriteBytes(dir / "a.npy", NpyBytes({frames.size(), 4, 4, 3},
                                     std::span<const int16_t>(array)));
  WriteBytes(dir / "trials.csv", "frames,label\na.npy,press\n");
  WriteBytes(dir / "skin.json", R"({"name": "xela-4x4", "rows": 4,
      "columns": 4, "row_pitch_m": 0.0047, "column_pitch_m": 0.0047,
      "unit": "counts", "contact_threshold": 100, "onset_threshold": 200,
      "axes": 3, "normal_axis": 2, "signed_values": true,
      "sample_rate_hz": 100})");
  const auto trials = ImportAll(dir.path());
  ASSERT_TRUE(trials.ok()) << trials.status();
  const Trial& trial = trials->front();
  ASSERT_EQ(trial.taxels.frames(), frames.size());
  EXPECT_EQ(SkinDifference(*trial.skin, info->layout), "");

  const SkinTracker::Options options = {
      .max_contacts = 8, .load_spread = true, .shear = true};
  SkinTracker streamed(info->layout, options);
  SkinTracker imported(*trial.skin, options);
  std::vector<double> got;
  std::vector<double> want;
  std::vector<float> values(info->layout.values());
  for (size_t t = 0; t < frames.size(); ++t) {
    std::ranges::copy(frames[t].i16, values.begin());
    streamed.Step({.taxels = values});
    AppendFeatures(streamed, got);
    trial.taxels.Decode(t, values.data());
    imported.Step({.taxels = values});
    AppendFeatures(imported, want);
  }
  EXPECT_EQ(got, want);
  // Presses begin at 2, 6, 10, 14 and 18 s.
  EXPECT_EQ(streamed.contacts_begun(), 5U);
  EXPECT_GT(got.size(), 9U * 700);
}

TEST(XelaSkinTest, LossesRepetitionsAndBreaksAreThoseOfAnySkin) {
  ManualClock clock;
  XelaPatch patch(PressTaxel5);
  MemoryBus bus(&patch, &clock);
  XelaSkin skin({.board = 1});
  CanSkinDriver driver(&bus, &skin, {}, &clock);
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  int count = 0;
  // Every fifth frame comes twice; one scan in ten lacks a frame.
  bus.copies = [&](const CanFrame&) {
    ++count;
    return count % 160 == 0 ? 0 : count % 5 == 0 ? 2 : 1;
  };
  SkinFrame frame;
  int frames = 0;
  uint64_t missing = 0;
  const int64_t begin_ns = clock.NowNs();
  while (clock.NowNs() < begin_ns + 10'000'000'000) {
    if (*driver.Read(frame) != ReadResult::kFrame) continue;
    ++frames;
    missing += frame.missing_before;
  }
  EXPECT_NEAR(frames, 900, 5);
  EXPECT_NEAR(static_cast<double>(missing), 100, 5);
  EXPECT_GE(driver.Statistics().incomplete, 95u);
  bus.broken = "bus-off";
  ASSERT_TRUE(driver.Read(frame).ok());
  while (*driver.Read(frame) != ReadResult::kFrame) continue;
  EXPECT_EQ(driver.Statistics().reconnects, 1u);
}

TEST(XelaSkinTest, ConfigureNamesWhatIsMissing) {
  ManualClock clock;
  XelaPatch patch(PressTaxel5);
  MemoryBus bus(&patch, &clock);
  XelaSkin absent({.board = 2});
  CanSkinDriver none(&bus, &absent, {}, &clock);
  EXPECT_THAT(std::string(none.Configure().status().message()),
              HasSubstr("XELA patch: it sends nothing"));
  patch.dead_taxel = 9;
  XelaSkin lacking({.board = 1});
  CanSkinDriver driver(&bus, &lacking, {}, &clock);
  const absl::Status status = driver.Configure().status();
  EXPECT_EQ(ReasonOf(status), "IO");
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("nothing comes from taxels 9"));
}

}  // namespace
}  // namespace tactus::internal::client
