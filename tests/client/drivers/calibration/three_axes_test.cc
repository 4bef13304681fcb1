// What is measured of skins of three axes, and of signed values, whose offsets,
// noise, cross-talk, drift and faults are known.
#include <cmath>

#include "client/drivers/calibration/calibration.h"
#include "client/drivers/calibration/drift_tracker.h"
#include "client/drivers/calibration/press_sweep.h"
#include "client/drivers/calibration/tare.h"
#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/calibration/three_axis_skin.h"

namespace tactus::internal::client {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::ReadIdle;
using testing::SyntheticSkin;
using testing::ThreeAxisSkin;

TEST(ThreeAxesTest, FindsTheOffsetAndTheNoiseOfEachAxis) {
  ThreeAxisSkin skin({});
  for (size_t i = 0; i < 96; ++i) skin.noise[i] = i % 3 == 0 ? 6 : 2;
  const auto made = Calibrate(ReadIdle(skin, 400), {.device = "bench"});
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_TRUE(Validate(*made).ok()) << Validate(*made);
  ASSERT_EQ(made->baseline.size(), 96U);
  ASSERT_EQ(made->contact_threshold.size(), 32U);
  for (size_t i = 0; i < 96; ++i) {
    // 5 standard errors of the mean of 400 frames.
    EXPECT_NEAR(made->baseline[i], skin.offset[i], 5 * skin.noise[i] / 20) << i;
    EXPECT_NEAR(made->deviation[i], skin.noise[i], 0.2 * skin.noise[i]) << i;
  }
  EXPECT_TRUE(made->faults.All().empty());
}

// The rule of `trainctl skin estimate` for the loads along z, by brute force.
TEST(ThreeAxesTest, ThresholdsAreThoseOfTheLoads) {
  for (const bool matrices : {false, true}) {
    ThreeAxisSkin skin({.seed = 3});
    const IdleFrames idle = ReadIdle(skin, 500);
    const auto made =
        Calibrate(idle, {.device = "bench",
                         .cross_axis = matrices ? skin.Truths() : CrossAxes()});
    ASSERT_TRUE(made.ok()) << made.status();
    double most = 0;
    for (size_t taxel = 0; taxel < 32; ++taxel) {
      Eigen::Matrix3d inverse = Eigen::Matrix3d::Identity();
      if (matrices) inverse = skin.counts_per_newton[taxel].inverse();
      std::vector<double> loads;
      for (size_t t = 0; t < idle.frames(); ++t) {
        Eigen::Vector3d reading;
        for (int axis = 0; axis < 3; ++axis) {
          const size_t i = 3 * taxel + axis;
          reading[axis] = idle.Frame(t)[i] - made->baseline[i];
        }
        loads.push_back(std::max(0.0, (inverse * reading)[2]));
      }
      std::ranges::sort(loads);
      const double step = inverse.row(2).cwiseAbs().maxCoeff();
      const double margin = std::max((loads[499] - loads[250]) / 2, step);
      EXPECT_NEAR(made->contact_threshold[taxel] / (loads[499] + margin), 1,
                  1e-9);
      EXPECT_NEAR(made->onset_threshold[taxel] / (loads[499] + 2 * margin), 1,
                  1e-9);
      most = std::max(most, made->onset_threshold[taxel]);
    }
    // Loads of matrices are in the layout's unit already.
    EXPECT_EQ(ThresholdsFor(*made, 0.5).onset_threshold,
              matrices ? most : 0.5 * most);
  }
}

TEST(ThreeAxesTest, WithoutANormalAxisThresholdsAreThoseOfTheDistance) {
  ThreeAxisSkin skin({.seed = 3});
  skin.info.layout.normal_axis.reset();
  const IdleFrames idle = ReadIdle(skin, 500);
  const auto made = Calibrate(idle, {.device = "bench"});
  ASSERT_TRUE(made.ok()) << made.status();
  std::vector<double> loads;
  for (size_t t = 0; t < idle.frames(); ++t) {
    loads.push_back(std::hypot(idle.Frame(t)[15] - made->baseline[15],
                               idle.Frame(t)[16] - made->baseline[16],
                               idle.Frame(t)[17] - made->baseline[17]));
  }
  std::ranges::sort(loads);
  const double margin = (loads[499] - loads[250]) / 2;
  EXPECT_NEAR(made->contact_threshold[5], loads[499] + margin, 1e-9);
}

TEST(ThreeAxesTest, ATouchThatIsOnlyShearIsNoTare) {
  for (size_t axis = 0; axis < 3; ++axis) {
    ThreeAxisSkin skin({});
    const auto load = skin.load;
    skin.load = [&](int64_t frame, size_t value) {
      return load(frame, value) -
             (value == 3 * 13 + axis && frame >= 50 ? 30. : 0.);
    };
    const absl::Status status = Tare(ReadIdle(skin, 100), nullptr).status();
    EXPECT_EQ(ReasonOf(status), "INVALID_TRAINING_DATA");
    EXPECT_THAT(status.message(),
                HasSubstr(absl::StrCat("the skin is touched: taxel 13 changed "
                                       "along ",
                                       kAxisNames[axis], " by ")));
  }
}

TEST(ThreeAxesTest, AnUntouchedSkinIsNotRefused) {
  for (uint64_t seed = 1; seed <= 50; ++seed) {
    ThreeAxisSkin skin({.seed = seed});
    skin.drift = [](int64_t frame) {
      return 0.02 * static_cast<double>(frame);
    };
    EXPECT_TRUE(Tare(ReadIdle(skin, 100), nullptr).ok()) << seed;
  }
}

// What rests on the skin, or pulls at it, shows beside an earlier calibration.
TEST(ThreeAxesTest, WhatRestsOnTheSkinIsRefusedBesideAnEarlierCalibration) {
  for (const bool matrices : {false, true}) {
    ThreeAxisSkin before({.seed = 1});
    const auto earlier =
        Calibrate(ReadIdle(before, 300),
                  {.device = "bench",
                   .cross_axis = matrices ? before.Truths() : CrossAxes()});
    ASSERT_TRUE(earlier.ok()) << earlier.status();
    const std::pair<AxisVector, const char*> loads[] = {
        {{0, 0, 0}, ""},
        {{0, 0, 0.2}, "along z"},
        {{0.2, 0, 0}, "along x"},
        {{0, -0.2, 0}, "along y"}};
    for (const auto& [newton, axis] : loads) {
      ThreeAxisSkin skin({.seed = 2});
      // The whole skin has drifted by 30 counts.
      skin.drift = [](int64_t) { return 30.; };
      skin.newtons = [&n = newton](int64_t, size_t taxel) {
        return taxel == 9 ? n : AxisVector{};
      };
      const auto again = Calibrate(ReadIdle(skin, 300),
                                   {.device = "bench", .before = &*earlier});
      EXPECT_EQ(again.ok(), *axis == '\0') << again.status();
      if (*axis == '\0') continue;
      EXPECT_THAT(again.status().message(),
                  HasSubstr(absl::StrCat("taxel 9 is ", axis)));
      EXPECT_THAT(again.status().message(),
                  HasSubstr(newton[1] < 0 ? " below its baseline"
                                          : " above its baseline"));
    }
  }
}

TEST(ThreeAxesTest, ATaxelIsFaultyIfOneOfItsAxesIs) {
  SyntheticSkin skin({.rows = 8, .columns = 8, .axes = 3});
  // Usual offsets of the axes differ by more than any outstanding taxel.
  for (size_t i = 0; i < skin.offset.size(); ++i) {
    skin.offset[i] = 50 + 400 * static_cast<double>(i % 3);
  }
  skin.stuck[3 * 5] = 50;
  skin.stuck[3 * 20 + 1] = 650;
  skin.stuck[3 * 21 + 2] = 100;
  skin.noise[3 * 40 + 2] = 30;
  // Two faults: the graver one.
  skin.noise[3 * 41] = 30;
  skin.stuck[3 * 41 + 1] = 32'767;
  // High, but alive.
  skin.offset[3 * 50] = -300;
  const IdleFrames idle = ReadIdle(skin, 300);
  const auto made = Calibrate(idle, {.device = "bench"});
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_THAT(made->faults.dead, ElementsAre(5));
  // Taxel 21 is far below the others on its axis.
  EXPECT_THAT(made->faults.stuck, ElementsAre(20, 21, 41));
  EXPECT_THAT(made->faults.noisy, ElementsAre(40));
  EXPECT_THAT(OutstandingTaxels(idle, made->baseline),
              ElementsAre(20, 21, 41, 50));
}

TEST(ThreeAxesTest, ASweepFindsTaxelsByTheirLoads) {
  ThreeAxisSkin skin({.noise = 1});
  const IdleFrames idle = ReadIdle(skin, 200);
  const auto made =
      Calibrate(idle, {.device = "bench", .cross_axis = skin.Truths()});
  ASSERT_TRUE(made.ok()) << made.status();
  PressSweep sweep(idle, *made);
  // Taxel 3 is only pulled at, and taxel 7 feels nothing.
  skin.newtons = [](int64_t, size_t taxel) {
    return taxel == 7   ? AxisVector{}
           : taxel == 3 ? AxisVector{1, 0, 0}
                        : AxisVector{0, 0, 0.5};
  };
  SkinFrame frame;
  for (int t = 0; t < 10; ++t) {
    ASSERT_TRUE(skin.Read(frame).ok());
    sweep.Add(frame);
  }
  EXPECT_TRUE(sweep.changed());
  EXPECT_THAT(sweep.Unfelt(), ElementsAre(3, 7));
}

TEST(ThreeAxesTest, ACalibrationFitsItsAxesOnly) {
  ThreeAxisSkin skin({});
  const auto made = Calibrate(ReadIdle(skin, 100), {.device = "palm"});
  ASSERT_TRUE(made.ok()) << made.status();
  SkinLayout layout = skin.info.layout;
  EXPECT_TRUE(CheckFits(*made, "palm", layout).ok());
  layout.normal_axis = 0;
  EXPECT_THAT(CheckFits(*made, "palm", layout).message(),
              HasSubstr("axes of the calibration is 3, signed, normal z; it "
                        "must be 3, signed, normal x, those of the skin"));
  layout = skin.info.layout;
  layout.signed_values = false;
  EXPECT_THAT(CheckFits(*made, "palm", layout).message(),
              HasSubstr("must be 3, normal z"));
  layout.axes = 1;
  layout.normal_axis.reset();
  EXPECT_THAT(CheckFits(*made, "palm", layout).message(),
              HasSubstr("must be 1, those"));
}

TEST(ThreeAxesTest, TaxelsThatCountNeedAMatrixIfOthersHaveOne) {
  ThreeAxisSkin skin({});
  skin.info.layout.mask.assign(32, 1);
  skin.info.layout.mask[6] = 0;
  const IdleFrames idle = ReadIdle(skin, 100);
  CrossAxes matrices = skin.Truths();
  matrices[6].reset();
  auto made = Calibrate(idle, {.device = "palm", .cross_axis = matrices});
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_TRUE(Validate(*made).ok()) << Validate(*made);
  // The layout in use does not mask the taxel.
  SkinLayout layout = skin.info.layout;
  EXPECT_TRUE(CheckFits(*made, "palm", layout).ok());
  layout.mask.clear();
  EXPECT_THAT(CheckFits(*made, "palm", layout).message(),
              HasSubstr("cross_axis of taxel 6 is absent; it must be given"));
  made->faults.dead = {6};
  EXPECT_TRUE(CheckFits(*made, "palm", layout).ok());
  made->cross_axis[8].reset();
  EXPECT_THAT(Validate(*made).message(), HasSubstr("cross_axis of taxel 8"));
}

TEST(ThreeAxesTest, CurvesAreOfOneAxisAndMatricesOfThree) {
  ThreeAxisSkin skin({});
  auto three = Calibrate(ReadIdle(skin, 100), {.device = "palm"});
  ASSERT_TRUE(three.ok()) << three.status();
  three->gains.resize(32);
  EXPECT_THAT(Validate(*three).message(),
              HasSubstr("gains is given for three axes; it must be empty: "
                        "cross_axis"));
  SyntheticSkin flat({});
  const IdleFrames idle = ReadIdle(flat, 100);
  const absl::Status one =
      Calibrate(idle, {.device = "palm", .cross_axis = {skin.Truth(0)}})
          .status();
  EXPECT_EQ(ReasonOf(one), "INVALID_CONFIG");
  EXPECT_THAT(one.message(), HasSubstr("cross_axis is given for one axis"));
  ThreeAxisSkin other({});
  EXPECT_THAT(Calibrate(ReadIdle(other, 100),
                        {.device = "palm",
                         .cross_axis = {skin.Truth(0), skin.Truth(1)}})
                  .status()
                  .message(),
              HasSubstr("matrices of cross_axis is 2"));
}

// A pull along x alone freezes all drifts.
TEST(ThreeAxesTest, ShearFreezesTheDrift) {
  Calibration pair;
  pair.layout = SyntheticSkin({.rows = 1, .columns = 2, .axes = 3}).info.layout;
  pair.contact_threshold = {8, 8};
  // The noise along y of taxel 1 reaches 6 x 2 counts.
  pair.deviation = {1, 1, 1, 1, 2, 1};
  for (const bool matrices : {false, true}) {
    if (matrices) {
      CrossAxis half;
      for (size_t i = 0; i < 3; ++i) half.rows[i][i] = 0.5;
      pair.cross_axis = {half};
    }
    const TouchThresholds thresholds(pair);
    const std::pair<std::vector<double>, bool> cases[] = {
        {{0, 0, 0, 0, 0, 7.9}, false},  {{0, 0, 0, 0, 0, 8}, true},
        {{0, 0, 0, 0, 0, -8}, true},    {{-8, 0, 0, 0, 0, 0}, true},
        {{0, 0, 0, 0, 11.9, 0}, false}, {{0, 0, 0, 0, -12, 0}, true}};
    for (auto [above, touched] : cases) {
      if (matrices) {
        // A load of half a newton per count: the threshold is 8 newtons, and
        // the noise 6 x 1 newtons.
        for (double& number : above) number *= 2;
        if (above[4] != 0) touched = std::abs(above[4]) / 2 >= 8;
      }
      DriftTracker drift(6, {.time_s = 10, .sample_rate_hz = 100});
      drift.Step(above, thresholds, {});
      EXPECT_EQ(drift.frozen(), touched) << ::testing::PrintToString(above);
      EXPECT_EQ(drift.drift()[5] == 0 && drift.drift()[4] == 0 &&
                    drift.drift()[0] == 0,
                touched);
    }
  }
}

TEST(OneSignedAxisTest, ATouchMayBeBelowTheBaseline) {
  for (const bool normal : {false, true}) {
    const auto skin_of = [&](uint64_t seed) {
      SyntheticSkin skin({.seed = seed});
      skin.info.layout.signed_values = true;
      skin.info.taxel_type = v1::TAXEL_TYPE_INT16;
      if (normal) skin.info.layout.normal_axis = 0;
      return skin;
    };
    SyntheticSkin before = skin_of(1);
    const auto earlier = Calibrate(ReadIdle(before, 300), {.device = "bench"});
    ASSERT_TRUE(earlier.ok()) << earlier.status();
    SyntheticSkin skin = skin_of(2);
    skin.load = [](int64_t, size_t taxel) { return taxel == 9 ? -40. : 0.; };
    const absl::Status status =
        Calibrate(ReadIdle(skin, 300), {.device = "bench", .before = &*earlier})
            .status();
    EXPECT_THAT(status.message(), HasSubstr("taxel 9 is "));
    EXPECT_THAT(status.message(), HasSubstr(" below its baseline"));
    DriftTracker drift(32, {.time_s = 10, .sample_rate_hz = 100});
    std::vector<double> above(32);
    above[3] = -40;
    drift.Step(above, TouchThresholds(*earlier), {});
    EXPECT_TRUE(drift.frozen());
  }
}

}  // namespace
}  // namespace tactus::internal::client
