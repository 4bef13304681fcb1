// What is measured of a skin whose offsets, noise and faults are known.
#include "client/drivers/calibration/calibration.h"

#include <cmath>
#include <numbers>

#include "client/drivers/calibration/drift_tracker.h"
#include "client/drivers/calibration/press_sweep.h"
#include "client/drivers/calibration/tare.h"
#include "client/drivers/sim_driver.h"
#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/calibration/synthetic_skin.h"
#include "tests/client/drivers/calibration/three_axis_skin.h"
#include "tests/support/flat_layout.h"

namespace tactus::internal::client {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::ReadIdle;
using testing::SyntheticSkin;

TEST(TareTest, FindsTheOffsetsOfTheTaxels) {
  SyntheticSkin skin({});
  for (size_t i = 0; i < 32; ++i) {
    skin.offset[i] = 20 + 9 * static_cast<double>(i);
  }
  const auto baseline = Tare(ReadIdle(skin, 400), nullptr);
  ASSERT_TRUE(baseline.ok()) << baseline.status();
  // 5 standard errors of the mean of 400 frames.
  for (size_t i = 0; i < 32; ++i) {
    EXPECT_NEAR((*baseline)[i], skin.offset[i], 5 * 2 / std::sqrt(400)) << i;
  }
}

TEST(TareTest, AnUntouchedSkinIsNotRefused) {
  for (uint64_t seed = 1; seed <= 50; ++seed) {
    for (const double noise : {0., 0.2, 1., 20.}) {
      SyntheticSkin skin({.noise = noise, .seed = seed});
      // Warms up by 2 counts meanwhile.
      skin.load = [](int64_t frame, size_t) {
        return 0.02 * static_cast<double>(frame);
      };
      EXPECT_TRUE(Tare(ReadIdle(skin, 100), nullptr).ok())
          << seed << " " << noise;
    }
  }
}

TEST(TareTest, ATouchWhileItLastsIsRefused) {
  const std::pair<const char*, std::function<double(int64_t)>> touches[] = {
      {"begins", [](int64_t t) { return t >= 50 ? 30. : 0.; }},
      {"ends", [](int64_t t) { return t < 70 ? 30. : 0.; }},
      {"a tap", [](int64_t t) { return t >= 30 && t < 45 ? 40. : 0.; }},
      {"a finger that is not still", [](int64_t t) {
         return 60 + 25 * std::sin(std::numbers::pi * t / 100.);
       }}};
  for (const auto& [name, load] : touches) {
    SyntheticSkin skin({});
    skin.load = [&load = load](int64_t frame, size_t taxel) {
      return taxel == 13 ? load(frame) : 0;
    };
    const auto baseline = Tare(ReadIdle(skin, 100), nullptr);
    EXPECT_EQ(ReasonOf(baseline.status()), "INVALID_TRAINING_DATA") << name;
    EXPECT_THAT(baseline.status().message(),
                HasSubstr("the skin is touched: taxel 13 changed by"))
        << name;
  }
}

TEST(TareTest, AMaskedTaxelIsNotExamined) {
  SyntheticSkin skin({});
  skin.info.layout.mask.assign(32, 1);
  skin.info.layout.mask[13] = 0;
  skin.load = [](int64_t frame, size_t taxel) {
    return taxel == 13 && frame > 50 ? 300. : 0.;
  };
  EXPECT_TRUE(Tare(ReadIdle(skin, 100), nullptr).ok());
}

// Its noise alone does not show that it is there.
TEST(TareTest, AWeightAtRestIsRefusedBesideAnEarlierCalibration) {
  SyntheticSkin before({.seed = 1});
  const auto earlier = Calibrate(ReadIdle(before, 300), {.device = "bench"});
  ASSERT_TRUE(earlier.ok()) << earlier.status();
  for (const double weight : {0., 40.}) {
    SyntheticSkin skin({.seed = 2});
    // The whole skin has drifted by 30 counts.
    skin.load = [&](int64_t, size_t taxel) {
      return 30 + (taxel == 9 ? weight : 0);
    };
    const IdleFrames idle = ReadIdle(skin, 300);
    EXPECT_TRUE(Calibrate(idle, {.device = "bench"}).ok());
    const auto again =
        Calibrate(idle, {.device = "bench", .before = &*earlier});
    EXPECT_EQ(again.ok(), weight == 0) << again.status();
    if (weight > 0) {
      EXPECT_THAT(again.status().message(), HasSubstr("taxel 9 is "));
    }
  }
}

// A skin that sends each measurement four times, as floats.
TEST(TareTest, RepeatedFloatsAreNoTouch) {
  for (uint64_t seed = 1; seed <= 50; ++seed) {
    for (const float touch : {0.F, 30.F}) {
      SkinInfo info = SyntheticSkin({}).info;
      info.taxel_type = v1::TAXEL_TYPE_FLOAT32;
      const auto taxels = static_cast<size_t>(info.layout.taxels());
      Random random(seed);
      IdleFrames idle(info, 200);
      SkinFrame frame;
      for (size_t t = 0; !idle.complete(); ++t) {
        frame.f32.resize(taxels);
        for (size_t i = 0; i < taxels && t % 4 == 0; ++i) {
          frame.f32[i] = 100 + 2 * static_cast<float>(random.Gaussian());
          if (t >= 100 && i == 5) frame.f32[i] += touch;
        }
        idle.Add(frame);
      }
      EXPECT_EQ(Tare(idle, nullptr).ok(), touch == 0) << "seed " << seed;
    }
  }
}

TEST(TareTest, FewFramesAreRefused) {
  SyntheticSkin skin({});
  EXPECT_EQ(ReasonOf(Tare(ReadIdle(skin, 19), nullptr).status()),
            "INVALID_CONFIG");
}

// The noise of the simulated skins, whose contacts begin after a second.
TEST(TareTest, SimulatedSkinsAreTaredBeforeTheTouchOnly) {
  for (const char* name : {"good", "measured"}) {
    SimDriver before({.seed = 3, .skin = name}, 1, {});
    const IdleFrames idle = ReadIdle(before, 90);
    EXPECT_TRUE(Tare(idle, nullptr).ok()) << name;
    SimDriver during({.seed = 3, .skin = name}, 1, {});
    EXPECT_EQ(ReasonOf(Tare(ReadIdle(during, 300), nullptr).status()),
              "INVALID_TRAINING_DATA")
        << name;
  }
}

TEST(CalibrateTest, ThresholdsFollowTheNoiseOfEachTaxel) {
  SyntheticSkin skin({.rows = 8, .columns = 8});
  for (size_t i = 0; i < 64; ++i) skin.noise[i] = i % 2 == 0 ? 2 : 6;
  const auto made = Calibrate(ReadIdle(skin, 2'000), {.device = "bench"});
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_EQ(made->frames, 2'000);
  for (size_t i = 0; i < 64; ++i) {
    EXPECT_NEAR(made->deviation[i], skin.noise[i], 0.15 * skin.noise[i]);
    // q = 3.09 deviations for a Gaussian; margin = q / 2; steps of 1.
    const double q = 3.09 * skin.noise[i];
    EXPECT_NEAR(made->contact_threshold[i], 1.5 * q, 0.4 * q + 1) << i;
    EXPECT_NEAR(made->onset_threshold[i], 2 * q, 0.5 * q + 1) << i;
  }
  // A margin of 20 counts is more than half of the range.
  SyntheticSkin again({});
  const auto wide =
      Calibrate(ReadIdle(again, 400), {.device = "bench", .least_margin = 20});
  ASSERT_TRUE(wide.ok()) << wide.status();
  for (size_t i = 0; i < 32; ++i) {
    EXPECT_NEAR(wide->contact_threshold[i], 3 * 2 + 20, 3) << i;
    EXPECT_NEAR(wide->onset_threshold[i] - wide->contact_threshold[i], 20,
                1e-9);
  }
  const LayoutThresholds layout = ThresholdsFor(*made, 0.1);
  EXPECT_EQ(layout.contact_threshold,
            0.1 * *std::ranges::max_element(made->contact_threshold));
  EXPECT_EQ(layout.onset_threshold,
            0.1 * *std::ranges::max_element(made->onset_threshold));
}

TEST(CalibrateTest, NamesDeadStuckAndNoisyTaxels) {
  SyntheticSkin skin({.rows = 8, .columns = 8});
  skin.stuck[5] = 50;
  skin.stuck[20] = 250;
  skin.stuck[21] = 65'535;
  skin.noise[40] = 30;
  // High, but alive.
  skin.offset[50] = 300;
  const auto made = Calibrate(ReadIdle(skin, 300), {.device = "bench"});
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_THAT(made->faults.dead, ElementsAre(5));
  EXPECT_THAT(made->faults.stuck, ElementsAre(20, 21));
  EXPECT_THAT(made->faults.noisy, ElementsAre(40));
  EXPECT_THAT(made->faults.All(), ElementsAre(5, 20, 21, 40));
  // The noisy taxel raises no threshold of the layout.
  EXPECT_LT(ThresholdsFor(*made, 1).contact_threshold, 20);
  EXPECT_THAT(WithMasked(skin.info.layout, made->faults.All()).mask[20], 0);
}

// Such as the iCub's, which takes its own baseline.
TEST(CalibrateTest, ASkinThatReadsZeroAtRestHasNoDeadTaxels) {
  SyntheticSkin skin({.noise = 0});
  for (double& offset : skin.offset) offset = 0;
  skin.stuck[7] = 90;
  const IdleFrames idle = ReadIdle(skin, 200);
  const auto made = Calibrate(idle, {.device = "bench", .pressed_later = true});
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_THAT(made->faults.dead, IsEmpty());
  EXPECT_THAT(made->faults.stuck, ElementsAre(7));
  // Pressed everywhere, all but taxels 7 and 12 answer.
  PressSweep sweep(idle, *made);
  EXPECT_TRUE(sweep.changed() == false && sweep.Unfelt().size() == 32);
  SkinFrame pressed;
  pressed.u16.assign(32, 60);
  pressed.u16[7] = 90;
  pressed.u16[12] = 0;
  sweep.Add(pressed);
  EXPECT_TRUE(sweep.changed());
  EXPECT_THAT(sweep.Unfelt(), ElementsAre(7, 12));
}

TEST(CalibrateTest, FitsItsDeviceAndItsShapeOnly) {
  SyntheticSkin skin({});
  const auto made = Calibrate(ReadIdle(skin, 100), {.device = "left palm"});
  ASSERT_TRUE(made.ok()) << made.status();
  SkinLayout layout = skin.info.layout;
  EXPECT_TRUE(CheckFits(*made, "left palm", layout).ok());
  layout.contact_threshold = 12;
  layout.mask.assign(32, 1);
  EXPECT_TRUE(CheckFits(*made, "left palm", layout).ok());
  EXPECT_THAT(CheckFits(*made, "right palm", layout).message(),
              HasSubstr("\"left palm\"; it must be \"right palm\""));
  for (const auto change :
       {+[](SkinLayout& l) { l.rows = 8; },
        +[](SkinLayout& l) { l.columns = 4; },
        +[](SkinLayout& l) { l.name = "other"; },
        +[](SkinLayout& l) { l.unit = TaxelUnit::kNewton; }}) {
    SkinLayout other = skin.info.layout;
    change(other);
    EXPECT_EQ(ReasonOf(CheckFits(*made, "left palm", other)), "INVALID_CONFIG");
  }
}

// Two taxels whose contact thresholds are 8.
TouchThresholds PairThresholds() {
  Calibration pair;
  pair.layout = tactus::internal::testing::FlatLayout("pair", 1, 2,
                                                      TaxelUnit::kCounts, 8, 9);
  pair.contact_threshold = {8, 8};
  pair.deviation = {1, 1};
  return TouchThresholds(pair);
}

TEST(DriftTrackerTest, FollowsADriftAndNeverAContact) {
  DriftTracker drift(2, {.time_s = 10, .sample_rate_hz = 100});
  const TouchThresholds thresholds = PairThresholds();
  // 0.2 counts per second for 100 s: an exponential mean lags by 10 s of it.
  std::vector<double> above(2);
  for (int t = 0; t < 10'000; ++t) {
    above = {0.002 * t, 0.002 * t};
    drift.Step(above, thresholds, {});
  }
  EXPECT_NEAR(drift.drift()[0], 20 - 2, 0.01);
  EXPECT_FALSE(drift.frozen());
  // Ten minutes of contact on taxel 0 change neither taxel.
  const double before = drift.drift()[1];
  for (int t = 0; t < 60'000; ++t) {
    drift.Step(std::vector<double>{above[0] + 30, above[1] + 5}, thresholds,
               {});
    ASSERT_TRUE(drift.frozen());
  }
  EXPECT_EQ(drift.drift()[1], before);
  // A second after it, the drift goes on.
  int held = 0;
  for (int t = 0; t < 200; ++t) {
    drift.Step(above, thresholds, {});
    held += drift.frozen();
  }
  EXPECT_EQ(held, 100);
  EXPECT_GT(drift.drift()[1], before);
}

TEST(DriftTrackerTest, AMaskedTaxelFreezesNothing) {
  DriftTracker drift(2, {.time_s = 10, .sample_rate_hz = 100});
  const std::vector<uint8_t> mask = {0, 1};
  drift.Step(std::vector<double>{1000, 1}, PairThresholds(), mask);
  EXPECT_FALSE(drift.frozen());
  EXPECT_GT(drift.drift()[1], 0);
}

}  // namespace
}  // namespace tactus::internal::client
