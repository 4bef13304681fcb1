// The driver that turns what a skin of three axes sends into loads.
#include <bit>
#include <cmath>

#include "client/drivers/calibrated_driver.h"
#include "client/drivers/can_skin_driver.h"
#include "client/drivers/xela/xela_skin.h"
#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/calibration/three_axis_skin.h"
#include "tests/client/drivers/memory_bus.h"
#include "tests/support/allocation_counter.h"
#include "tools/fakeskin/xela_patch.h"

namespace tactus::internal::client {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;
using testing::ReadIdle;
using testing::SyntheticSkin;
using testing::ThreeAxisSkin;

constexpr char kPalm[] = "palm";

// Matrices of noisy known loads.
CrossAxes FittedMatrices(const ThreeAxisSkin& skin) {
  CrossAxes matrices;
  for (size_t taxel = 0; taxel < 32; ++taxel) {
    matrices.emplace_back(
        FitCrossAxis(skin.KnownLoads(taxel, 40, 2, taxel + 1))->cross_axis);
  }
  return matrices;
}

// The next frame of a driver that has one.
SkinFrame NextFrame(SkinDriver& driver) {
  SkinFrame frame;
  EXPECT_EQ(*driver.Read(frame), ReadResult::kFrame);
  return frame;
}

TEST(ThreeAxisDriverTest, LoadsAreTheTrueOnesAlongAllAxes) {
  ThreeAxisSkin idle({.seed = 1});
  const auto made =
      Calibrate(ReadIdle(idle, 400),
                {.device = kPalm, .cross_axis = FittedMatrices(idle)});
  ASSERT_TRUE(made.ok()) << made.status();
  ASSERT_TRUE(Validate(*made).ok()) << Validate(*made);
  ThreeAxisSkin skin({.seed = 2});
  // A matrix makes newtons, whatever the scale.
  skin.info.scale = 0.25;
  CalibratedDriver driver(&skin, {.device = kPalm, .calibration = *made});
  const auto info = driver.Configure();
  ASSERT_TRUE(info.ok()) << info.status();
  EXPECT_EQ(info->taxel_type, v1::TAXEL_TYPE_FLOAT32);
  EXPECT_EQ(info->scale, 1);
  EXPECT_EQ(info->layout, skin.info.layout);
  ASSERT_TRUE(driver.Activate().ok());
  for (int t = 0; t < 200; ++t) {
    EXPECT_THAT(NextFrame(driver).f32, Each(0.F)) << t;
  }
  // Where a taxel is pressed it is also pulled.
  const auto newtons = [](size_t taxel) {
    if (taxel % 4 == 3) return AxisVector{};
    const auto place = static_cast<double>(taxel);
    return AxisVector{0.8 * std::cos(place), 0.8 * std::sin(place),
                      0.5 + place / 16};
  };
  skin.newtons = [&](int64_t, size_t taxel) { return newtons(taxel); };
  for (int t = 0; t < 100; ++t) {
    const SkinFrame frame = NextFrame(driver);
    ASSERT_EQ(frame.f32.size(), 96U);
    EXPECT_TRUE(frame.i16.empty() && frame.u16.empty());
    EXPECT_EQ(driver.raw().i16.size(), 96U);
    for (size_t i = 0; i < 96; ++i) {
      // 5 deviations of 2 counts at 250 counts a newton, and 1 % of cross-talk.
      EXPECT_NEAR(frame.f32[i], newtons(i / 3)[i % 3], 0.06) << t << " " << i;
      if (i / 3 % 4 == 3) {
        EXPECT_EQ(frame.f32[i], 0);
      }
    }
  }
}

// What cross-talk makes of a pull is no press: without the matrix it is one.
TEST(ThreeAxisDriverTest, CrossTalkIsNoLoad) {
  for (const bool matrices : {false, true}) {
    ThreeAxisSkin skin({.seed = 2});
    skin.counts_per_newton[9](2, 0) = 100;
    const auto made =
        Calibrate(ReadIdle(skin, 400),
                  {.device = kPalm,
                   .cross_axis = matrices ? skin.Truths() : CrossAxes()});
    ASSERT_TRUE(made.ok()) << made.status();
    ThreeAxisSkin pulled({.seed = 3});
    pulled.counts_per_newton = skin.counts_per_newton;
    pulled.newtons = [](int64_t, size_t taxel) {
      return taxel == 9 ? AxisVector{1, 0, 0} : AxisVector{};
    };
    CalibratedDriver driver(&pulled, {.device = kPalm, .calibration = *made});
    ASSERT_TRUE(driver.Configure().ok() && driver.Activate().ok());
    const SkinFrame frame = NextFrame(driver);
    for (size_t i = 27; i < 30; ++i) {
      EXPECT_EQ(frame.f32[i] == 0, matrices) << i;
    }
  }
}

// A skin without noise, in counts of 0.5.
struct PlainBench {
  PlainBench() : skin({.noise = 0, .axes = 3}) {
    skin.info.scale = 0.5;
    made.device = kPalm;
    made.layout = skin.info.layout;
    made.frames = 100;
    made.baseline.assign(96, 50);
    made.deviation.assign(96, 1);
    made.contact_threshold.assign(32, 8);
    made.onset_threshold.assign(32, 10);
    skin.load = [](int64_t, size_t value) {
      const double loads[][3] = {
          {-20, 5, 9}, {-20, 5, 7}, {30, 0, -9}, {0, -40, 0}};
      return value < 12 ? loads[value / 3][value % 3] : 0;
    };
  }
  SyntheticSkin skin;
  Calibration made;
};

// The loads of the first four taxels.
std::vector<float> PlainLoads(
    const std::function<void(SkinLayout&)>& change = [](SkinLayout&) {},
    double threshold = 8) {
  PlainBench bench;
  change(bench.skin.info.layout);
  change(bench.made.layout);
  bench.made.contact_threshold.assign(32, threshold);
  CalibratedDriver driver(&bench.skin,
                          {.device = kPalm, .calibration = bench.made});
  EXPECT_TRUE(driver.Configure().ok() && driver.Activate().ok());
  std::vector<float> loads = NextFrame(driver).f32;
  loads.resize(12);
  return loads;
}

TEST(ThreeAxisDriverTest, ATaxelBelowItsThresholdIsZeroOnAllAxes) {
  EXPECT_EQ(PlainLoads(),
            (std::vector<float>{-10, 2.5, 4.5, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
  // By the distance, all of them are touched.
  const auto distance = [](SkinLayout& layout) { layout.normal_axis.reset(); };
  EXPECT_EQ(PlainLoads(distance),
            (std::vector<float>{-10, 2.5, 4.5, -10, 2.5, 3.5, 15, 0, -4.5, 0,
                                -20, 0}));
  EXPECT_EQ(PlainLoads(distance, 31),
            (std::vector<float>{0, 0, 0, 0, 0, 0, 15, 0, -4.5, 0, -20, 0}));
  // Without signs, what is below the baseline is 0.
  const auto no_signs = [](SkinLayout& layout) {
    layout.normal_axis.reset();
    layout.signed_values = false;
  };
  EXPECT_EQ(PlainLoads(no_signs, 31),
            (std::vector<float>{0, 0, 0, 0, 0, 0, 15, 0, 0, 0, 0, 0}));
}

TEST(ThreeAxisDriverTest, LightTouchKeepsWhatIsBelowTheThresholds) {
  const auto light = [](SkinLayout& layout) {
    layout.light_touch = {.window_s = 0.1,
                          .rows = 3,
                          .columns = 3,
                          .contact_threshold = 1,
                          .onset_threshold = 2};
  };
  EXPECT_EQ(PlainLoads(light), (std::vector<float>{-10, 2.5, 4.5, -10, 2.5, 3.5,
                                                   15, 0, -4.5, 0, -20, 0}));
}

TEST(ThreeAxisDriverTest, OneSignedAxisKeepsItsSign) {
  for (const bool normal : {false, true}) {
    SyntheticSkin skin({.noise = 0});
    skin.info.taxel_type = v1::TAXEL_TYPE_INT16;
    skin.info.scale = 0.5;
    skin.info.layout.signed_values = true;
    if (normal) skin.info.layout.normal_axis = 0;
    skin.load = [](int64_t, size_t taxel) {
      return taxel == 0 ? -20. : taxel == 1 ? 20. : taxel == 2 ? -7. : 0.;
    };
    Calibration made;
    made.device = kPalm;
    made.layout = skin.info.layout;
    made.frames = 100;
    made.baseline.assign(32, 50);
    made.deviation.assign(32, 1);
    made.contact_threshold.assign(32, 8);
    made.onset_threshold.assign(32, 10);
    made.gains.resize(32);
    made.gains[1] = *GainCurve::Make({{10, 1}, {30, 5}});
    CalibratedDriver driver(&skin, {.device = kPalm, .calibration = made});
    ASSERT_TRUE(driver.Configure().ok() && driver.Activate().ok());
    const SkinFrame frame = NextFrame(driver);
    // With a normal axis a load below 0 is none.
    EXPECT_EQ(frame.f32[0], normal ? 0 : -10);
    EXPECT_EQ(frame.f32[1], 3);
    EXPECT_EQ(frame.f32[2], 0);
  }
}

TEST(ThreeAxisDriverTest, ATareAloneTakesTheOffsetsAway) {
  SyntheticSkin skin({.noise = 0, .axes = 3});
  for (size_t i = 0; i < 96; ++i) {
    skin.offset[i] = -40 + static_cast<double>(i);
  }
  CalibratedDriver driver(&skin, {.tare_frames = 20});
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  EXPECT_EQ(driver.in_use().tare, skin.offset);
  skin.load = [](int64_t, size_t value) { return value == 4 ? -3. : 0.; };
  const SkinFrame frame = NextFrame(driver);
  for (size_t i = 0; i < 96; ++i) EXPECT_EQ(frame.f32[i], i == 4 ? -3 : 0);
}

TEST(ThreeAxisDriverTest, ATareRefusesShearAndSkipsFaultyTaxels) {
  for (const bool faulty : {false, true}) {
    PlainBench bench;
    bench.skin.load = [](int64_t frame, size_t value) {
      return value == 28 && frame > 20 ? 60. : 0.;
    };
    if (faulty) bench.made.faults.noisy = {9};
    CalibratedDriver driver(
        &bench.skin,
        {.device = kPalm, .calibration = bench.made, .tare_frames = 40});
    const auto info = driver.Configure();
    ASSERT_TRUE(info.ok());
    EXPECT_EQ(info->layout.mask.size(), faulty ? 32U : 0U);
    const absl::Status active = driver.Activate();
    EXPECT_EQ(active.ok(), faulty) << active;
    if (faulty) continue;
    EXPECT_THAT(active.message(), HasSubstr("taxel 9 changed along y"));
  }
}

// 30 counts of drift on all axes are a false contact, unless they are followed.
// A long pull is not taken for one.
TEST(ThreeAxisDriverTest, TheDriftIsFollowedButDuringShear) {
  constexpr int64_t kPullBegin = 31'000;
  constexpr int64_t kPullEnd = 33'000;
  ThreeAxisSkin idle({.noise = 1, .seed = 1});
  const auto made = Calibrate(
      ReadIdle(idle, 400),
      {.device = kPalm, .least_margin = 4, .cross_axis = idle.Truths()});
  ASSERT_TRUE(made.ok()) << made.status();
  for (const double time_s : {0., 2.}) {
    ThreeAxisSkin skin({.noise = 1, .seed = 2});
    skin.drift = [](int64_t frame) {
      return std::min(30., 1e-3 * static_cast<double>(frame));
    };
    skin.newtons = [&](int64_t frame, size_t taxel) {
      const bool pulled = taxel == 3 && frame >= kPullBegin && frame < kPullEnd;
      return pulled ? AxisVector{0, 1, 0} : AxisVector{};
    };
    CalibratedDriver driver(
        &skin, {.device = kPalm, .calibration = *made, .drift_time_s = time_s});
    ASSERT_TRUE(driver.Configure().ok() && driver.Activate().ok());
    float largest = 0;
    int64_t frozen = 0;
    SkinFrame frame;
    for (int64_t t = 0; t < kPullEnd + 1'000; ++t) {
      ASSERT_EQ(*driver.Read(frame), ReadResult::kFrame);
      for (const float load : frame.f32) {
        largest = std::max(largest, std::abs(load));
      }
      frozen += t >= kPullBegin && t < kPullEnd && driver.drift_frozen();
    }
    EXPECT_EQ(largest == 0, time_s > 0) << largest;
    EXPECT_EQ(frozen, time_s > 0 ? kPullEnd - kPullBegin : 0);
  }
}

TEST(ThreeAxisDriverTest, TheSameFramesGiveTheSameBits) {
  std::vector<std::vector<float>> runs(2);
  for (std::vector<float>& run : runs) {
    ThreeAxisSkin skin({.noise = 9, .seed = 4});
    ThreeAxisSkin idle({.seed = 1});
    const auto made = Calibrate(ReadIdle(idle, 100),
                                {.device = kPalm, .cross_axis = idle.Truths()});
    ASSERT_TRUE(made.ok()) << made.status();
    CalibratedDriver driver(&skin, {.device = kPalm,
                                    .calibration = *made,
                                    .tare_frames = 50,
                                    .drift_time_s = 5});
    ASSERT_TRUE(driver.Configure().ok() && driver.Activate().ok());
    for (int t = 0; t < 200; ++t) {
      const SkinFrame frame = NextFrame(driver);
      run.insert(run.end(), frame.f32.begin(), frame.f32.end());
    }
  }
  ASSERT_EQ(runs[0].size(), runs[1].size());
  size_t loads = 0;
  for (size_t i = 0; i < runs[0].size(); ++i) {
    ASSERT_EQ(std::bit_cast<uint32_t>(runs[0][i]),
              std::bit_cast<uint32_t>(runs[1][i]));
    loads += runs[0][i] != 0;
  }
  EXPECT_GT(loads, 100U);
}

TEST(ThreeAxisDriverTest, WhatDoesNotFitIsRefused) {
  PlainBench bench;
  SyntheticSkin flat({});
  CalibratedDriver one_axis(&flat,
                            {.device = kPalm, .calibration = bench.made});
  EXPECT_THAT(one_axis.Configure().status().message(),
              HasSubstr("axes of the calibration is 3, signed, normal z; it "
                        "must be 1"));
  CalibratedDriver tared(&bench.skin, {.device = kPalm,
                                       .calibration = bench.made,
                                       .tare = std::vector<double>(32)});
  EXPECT_THAT(tared.Configure().status().message(),
              HasSubstr("numbers of the earlier tare is 32; it must be 96"));
}

TEST(ThreeAxisDriverTest, ReadAllocatesNothing) {
  PlainBench bench;
  CrossAxis half;
  for (size_t i = 0; i < 3; ++i) half.rows[i][i] = 0.5;
  bench.made.cross_axis.assign(32, half);
  CalibratedDriver driver(
      &bench.skin,
      {.device = kPalm, .calibration = bench.made, .drift_time_s = 5});
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  SkinFrame frame;
  for (int t = 0; t < 3; ++t) ASSERT_TRUE(driver.Read(frame).ok());
  const tactus::internal::testing::AllocationCounter counter;
  for (int t = 0; t < 100; ++t) ASSERT_TRUE(driver.Read(frame).ok());
  EXPECT_EQ(counter.count(), 0);
}

// The simulated XELA patch, whose taxel 5 is pressed and pulled after 8 s, with
// noise and cross-talk, through bus, driver, calibration and matrix.
TEST(ThreeAxisDriverTest, AXelaPatchSendsNewtons) {
  const ThreeAxisSkin truth({});
  const AxisVector newton = {0.6, -0.4, 2};
  Random random(8);
  ManualClock clock;
  XelaPatch patch([&](int64_t time_ns, std::span<double> counts) {
    for (double& count : counts) count = 3 * random.Gaussian();
    if (time_ns <= 8'000'000'000) return;
    const AxisVector reading = truth.Reading(0, newton);
    for (size_t axis = 0; axis < 3; ++axis) counts[15 + axis] += reading[axis];
  });
  MemoryBus bus(&patch, &clock);
  SkinLayout layout = XelaLayout();
  layout.unit = TaxelUnit::kNewton;
  XelaSkin xela({.board = 1, .layout = layout});
  CanSkinDriver can(&bus, &xela, {}, &clock);
  const auto made = Calibrate(
      ReadIdle(can, 300), {.device = kPalm, .cross_axis = {truth.Truth(0)}});
  ASSERT_TRUE(made.ok()) << made.status();
  ASSERT_TRUE(can.Finalise().ok());

  CanSkinDriver again(&bus, &xela, {}, &clock);
  CalibratedDriver driver(
      &again, {.device = kPalm, .calibration = *made, .tare_frames = 50},
      &clock);
  ASSERT_TRUE(driver.Configure().ok());
  const absl::Status active = driver.Activate();
  ASSERT_TRUE(active.ok()) << active;
  ASSERT_LT(clock.NowNs(), 7'000'000'000);
  SkinFrame frame;
  int untouched = 0;
  int touched = 0;
  while (clock.NowNs() < 10'000'000'000) {
    const auto result = driver.Read(frame);
    ASSERT_TRUE(result.ok()) << result.status();
    if (*result != ReadResult::kFrame) continue;
    const bool pressed = frame.capture_time_ns > 8'000'000'000;
    ++(pressed ? touched : untouched);
    for (size_t i = 0; i < 48; ++i) {
      const bool here = pressed && i / 3 == 5;
      // 5 deviations of 3 counts at some 250 counts a newton.
      EXPECT_NEAR(frame.f32[i], here ? newton[i % 3] : 0, here ? 0.08 : 0) << i;
    }
  }
  EXPECT_GT(untouched, 100);
  EXPECT_GT(touched, 190);
}

}  // namespace
}  // namespace tactus::internal::client
