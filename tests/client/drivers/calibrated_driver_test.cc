// The driver that turns what a skin sends into loads.
#include "client/drivers/calibrated_driver.h"

#include <bit>

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/calibration/synthetic_skin.h"
#include "tests/support/allocation_counter.h"

namespace tactus::internal::client {
namespace {

using ::testing::HasSubstr;
using testing::SyntheticSkin;

constexpr char kBench[] = "bench";

// A 4 x 8 skin without noise in counts of 0.5, at 50 + i.
struct Bench {
  Bench() : skin({.noise = 0}) {
    skin.info.scale = 0.5;
    calibration.device = kBench;
    calibration.layout = skin.info.layout;
    calibration.frames = 100;
    for (size_t i = 0; i < 32; ++i) {
      skin.offset[i] = 50 + static_cast<double>(i);
      calibration.baseline.push_back(skin.offset[i]);
      calibration.deviation.push_back(1);
      calibration.contact_threshold.push_back(8);
      calibration.onset_threshold.push_back(10);
    }
  }
  SyntheticSkin skin;
  Calibration calibration;
};

TEST(CalibratedDriverTest, TakesOffsetsAndNoiseAwayAndAppliesGains) {
  Bench bench;
  bench.calibration.gains.resize(32);
  bench.calibration.gains[3] = *GainCurve::Make({{10, 1}, {30, 5}});
  bench.skin.load = [](int64_t, size_t taxel) {
    return taxel == 1 ? 7. : taxel >= 2 && taxel <= 4 ? 20. : -3.;
  };
  CalibratedDriver driver(&bench.skin,
                          {.device = kBench, .calibration = bench.calibration});
  const auto info = driver.Configure();
  ASSERT_TRUE(info.ok()) << info.status();
  EXPECT_EQ(info->taxel_type, v1::TAXEL_TYPE_FLOAT32);
  EXPECT_EQ(info->scale, 1);
  EXPECT_EQ(info->layout, bench.skin.info.layout);
  ASSERT_TRUE(driver.Activate().ok());
  SkinFrame frame;
  ASSERT_TRUE(driver.Read(frame).ok());
  // Below its threshold of 8; by the scale; by the curve; below 0.
  EXPECT_EQ(frame.f32[1], 0);
  EXPECT_EQ(frame.f32[2], 10);
  EXPECT_EQ(frame.f32[3], 3);
  EXPECT_EQ(frame.f32[4], 10);
  EXPECT_EQ(frame.f32[5], 0);
  // What the skin sent stays available.
  EXPECT_EQ(driver.raw().u16[3], 50 + 3 + 20);
  EXPECT_EQ(driver.raw_info(), bench.skin.info);
}

TEST(CalibratedDriverTest, LightTouchKeepsWhatIsBelowTheThresholds) {
  Bench bench;
  bench.skin.info.layout.light_touch = {.window_s = 0.1,
                                        .rows = 3,
                                        .columns = 3,
                                        .contact_threshold = 1,
                                        .onset_threshold = 2};
  bench.skin.load = [](int64_t, size_t) { return 7.; };
  CalibratedDriver driver(&bench.skin,
                          {.device = kBench, .calibration = bench.calibration});
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  SkinFrame frame;
  ASSERT_TRUE(driver.Read(frame).ok());
  EXPECT_EQ(frame.f32[1], 3.5F);
}

TEST(CalibratedDriverTest, TheSameFramesGiveTheSameBits) {
  std::vector<std::vector<float>> runs;
  for (int run = 0; run < 2; ++run) {
    SyntheticSkin skin({.noise = 3, .seed = 4});
    skin.info.scale = 0.1;
    Bench bench;
    skin.offset = bench.skin.offset;
    CalibratedDriver driver(&skin, {.device = kBench,
                                    .calibration = bench.calibration,
                                    .tare_frames = 50,
                                    .drift_time_s = 5});
    ASSERT_TRUE(driver.Configure().ok());
    ASSERT_TRUE(driver.Activate().ok());
    runs.emplace_back();
    SkinFrame frame;
    for (int t = 0; t < 200; ++t) {
      ASSERT_TRUE(driver.Read(frame).ok());
      runs.back().insert(runs.back().end(), frame.f32.begin(), frame.f32.end());
    }
  }
  ASSERT_EQ(runs[0].size(), runs[1].size());
  for (size_t i = 0; i < runs[0].size(); ++i) {
    ASSERT_EQ(std::bit_cast<uint32_t>(runs[0][i]),
              std::bit_cast<uint32_t>(runs[1][i]));
  }
}

TEST(CalibratedDriverTest, TaresAtTheStartAndRefusesATouch) {
  for (const bool touched : {false, true}) {
    Bench bench;
    // 5 counts since the calibration.
    bench.skin.load = [&](int64_t frame, size_t taxel) {
      return touched && taxel == 9 && frame > 20 ? 60. : 5.;
    };
    CalibratedDriver driver(&bench.skin, {.device = kBench,
                                          .calibration = bench.calibration,
                                          .tare_frames = 40});
    ASSERT_TRUE(driver.Configure().ok());
    const absl::Status active = driver.Activate();
    if (touched) {
      EXPECT_EQ(ReasonOf(active), "INVALID_TRAINING_DATA");
      EXPECT_THAT(active.message(), HasSubstr("taxel 9"));
      EXPECT_EQ(driver.state(), DriverState::kInactive);
      EXPECT_EQ(bench.skin.state(), DriverState::kInactive);
      continue;
    }
    ASSERT_TRUE(active.ok()) << active;
    EXPECT_EQ(driver.baseline()[9], 50 + 9 + 5);
    SkinFrame frame;
    ASSERT_TRUE(driver.Read(frame).ok());
    EXPECT_EQ(frame.f32[9], 0);
  }
}

// Without a calibration a tare takes the offsets away, and nothing else.
TEST(CalibratedDriverTest, ATareAloneIsEnough) {
  Bench bench;
  CalibratedDriver driver(&bench.skin, {.tare_frames = 20});
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  bench.skin.load = [](int64_t, size_t taxel) { return taxel == 1 ? 3. : 0.; };
  SkinFrame frame;
  ASSERT_TRUE(driver.Read(frame).ok());
  EXPECT_EQ(frame.f32[0], 0);
  EXPECT_EQ(frame.f32[1], 1.5F);
}

TEST(CalibratedDriverTest, FaultyTaxelsAreMaskedAndDoNotStopATare) {
  Bench bench;
  bench.calibration.faults = {.dead = {4}, .stuck = {}, .noisy = {9}};
  bench.skin.load = [](int64_t frame, size_t taxel) {
    return taxel == 9 && frame > 20 ? 60. : 0.;
  };
  CalibratedDriver driver(
      &bench.skin,
      {.device = kBench, .calibration = bench.calibration, .tare_frames = 40});
  const auto info = driver.Configure();
  ASSERT_TRUE(info.ok());
  for (int i = 0; i < 32; ++i) {
    EXPECT_EQ(info->layout.mask[i], i == 4 || i == 9 ? 0 : 1) << i;
  }
  EXPECT_TRUE(driver.Activate().ok());
  bench.skin.stuck[4] = bench.skin.stuck[5] = 50;
  EXPECT_EQ(driver.Statistics().remarks, "faulty taxels masked: 4, 9");
  EXPECT_EQ(driver.Statistics().stuck_taxels, (std::vector<int>{5}));
}

TEST(CalibratedDriverTest, TheDriftIsFollowedOnRequestOnly) {
  for (const double time_s : {0., 2.}) {
    Bench bench;
    bench.skin.load = [](int64_t frame, size_t) {
      return 0.01 * static_cast<double>(frame);
    };
    CalibratedDriver driver(&bench.skin, {.device = kBench,
                                          .calibration = bench.calibration,
                                          .drift_time_s = time_s});
    ASSERT_TRUE(driver.Configure().ok());
    ASSERT_TRUE(driver.Activate().ok());
    SkinFrame frame;
    float largest = 0;
    for (int t = 0; t < 3'000; ++t) {
      ASSERT_TRUE(driver.Read(frame).ok());
      largest = std::max(largest, frame.f32[0]);
    }
    // 30 counts of drift are a false contact of 15.
    EXPECT_EQ(largest, time_s > 0 ? 0 : 15);
  }
}

TEST(CalibratedDriverTest, WhatCannotBeRightIsRefused) {
  Bench bench;
  const std::pair<CalibratedDriverOptions, const char*> cases[] = {
      {{}, "calibration is absent"},
      {{.tare_frames = 19}, "frames of a tare"},
      {{.tare_frames = 20, .drift_time_s = 5}, "to follow the drift"},
      {{.device = "other", .calibration = bench.calibration}, "device"},
  };
  for (const auto& [options, what] : cases) {
    SyntheticSkin skin({});
    CalibratedDriver driver(&skin, options);
    const auto info = driver.Configure();
    EXPECT_EQ(ReasonOf(info.status()), "INVALID_CONFIG") << what;
    EXPECT_THAT(info.status().message(), HasSubstr(what));
  }
  SyntheticSkin small({.rows = 2});
  CalibratedDriver driver(&small,
                          {.device = kBench, .calibration = bench.calibration});
  EXPECT_THAT(driver.Configure().status().message(),
              HasSubstr("4 x 8 taxels in counts; it must be"));
}

TEST(CalibratedDriverTest, AShortStreamIsNoTare) {
  SyntheticSkin skin({.frames = 30});
  CalibratedDriver driver(&skin, {.tare_frames = 40});
  ASSERT_TRUE(driver.Configure().ok());
  EXPECT_THAT(driver.Activate().message(), HasSubstr("only 30 of 40 frames"));
}

TEST(CalibratedDriverTest, ReadAllocatesNothing) {
  Bench bench;
  CalibratedDriver driver(
      &bench.skin,
      {.device = kBench, .calibration = bench.calibration, .drift_time_s = 5});
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  SkinFrame frame;
  for (int t = 0; t < 3; ++t) ASSERT_TRUE(driver.Read(frame).ok());
  const tactus::internal::testing::AllocationCounter counter;
  for (int t = 0; t < 100; ++t) ASSERT_TRUE(driver.Read(frame).ok());
  EXPECT_EQ(counter.count(), 0);
}

}  // namespace
}  // namespace tactus::internal::client
