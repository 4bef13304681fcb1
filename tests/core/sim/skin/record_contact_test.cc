#include "core/sim/skin/record_contact.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/errors.h"
#include "core/sim/exact/simulate_contact.h"
#include "core/sim/experiments/paper_set.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/sim/skin/ideal_skin.h"
#include "tests/support/find_material.h"

namespace tactus::internal {
namespace {

using testing::IdealSkin;

using ::testing::HasSubstr;

// A contact whose force is 2 N from the touch on.
SimulatedContact SteadyContact(size_t samples) {
  SimulatedContact contact;
  contact.spec.object = {*FindMaterial("steel"), 0.04, Surface::kWood};
  contact.signals.samples.assign(samples, {2, 0.0016, 0.003});
  contact.signals.object_motion.assign(samples, 0.001);
  return contact;
}

Placement Middle() {
  return {.centre = {.row = 7.5, .column = 4},
          .pose_noise_m = 0,
          .lead_in_frames = 10};
}

double NetForce(const Trial& trial, size_t frame) {
  std::vector<float> taxels(384);
  trial.taxels.Decode(frame, taxels.data());
  return std::accumulate(taxels.begin(), taxels.end(), 0.0);
}

TEST(RecordContactTest, WithoutNoiseTheTaxelsCarryTheForce) {
  Random random(1);
  const Trial trial =
      RecordContact(SteadyContact(5), IdealSkin(), Middle(), random);
  ASSERT_TRUE(Validate(trial, "here").ok());
  ASSERT_EQ(trial.taxels.frames(), 15);
  EXPECT_EQ(NetForce(trial, 9), 0);
  EXPECT_NEAR(NetForce(trial, 10), 2, 1e-5);
  EXPECT_EQ(trial.object_motion[9], 0);
  EXPECT_EQ(trial.object_motion[10], 0.001);
}

// The slow part of the reading is a first-order low-pass filter.
TEST(RecordContactTest, PartOfAReadingLags) {
  SkinModel skin = IdealSkin();
  skin.lagging = 0.25;
  skin.lag_s = 0.2;
  Random random(1);
  const Trial trial = RecordContact(SteadyContact(100), skin, Middle(), random);
  for (const int j : {0, 19, 99}) {
    const double follows = 1 - std::exp(-(j + 1) * 0.01 / 0.2);
    EXPECT_NEAR(NetForce(trial, 10 + j), 2 * (0.75 + 0.25 * follows), 1e-5);
  }
}

TEST(RecordContactTest, OffsetsDriftAsTheRootOfTime) {
  SkinModel skin = IdealSkin();
  skin.drift_n = 0.1;
  // Readings end at 0, so only those above are looked at.
  skin.stray_taxels = 2000;
  skin.stray_min_n = skin.stray_max_n = 1;
  Random random(2);
  Placement placement = Middle();
  placement.lead_in_frames = 401;
  const Trial trial = RecordContact(SteadyContact(1), skin, placement, random);
  std::vector<float> taxels(384);
  const auto deviation = [&](size_t frame) {
    trial.taxels.Decode(frame, taxels.data());
    double sum = 0;
    int count = 0;
    for (const float taxel : taxels) {
      if (taxel < 0.1) continue;  // a taxel that no stray was drawn for
      sum += (taxel - 1) * (taxel - 1);
      ++count;
    }
    return std::sqrt(sum / count);
  };
  EXPECT_NEAR(deviation(99), 0.1, 0.015);
  EXPECT_NEAR(deviation(399), 0.2, 0.03);
}

TEST(RecordContactTest, StraysReadTheirOffsetAndDeadTaxelsNothing) {
  SkinModel skin = IdealSkin();
  skin.stray_taxels = 3;
  skin.stray_min_n = 0.02;
  skin.stray_max_n = 0.1;
  skin.dead_taxels = 384 - 100;
  Random random(3);
  const Trial trial = RecordContact(SteadyContact(1), skin, Middle(), random);
  std::vector<float> taxels(384);
  trial.taxels.Decode(0, taxels.data());
  for (const float taxel : taxels) {
    if (taxel == 0) continue;
    EXPECT_GE(taxel, 0.02f);
    EXPECT_LE(taxel, 0.1f);
  }
  trial.taxels.Decode(10, taxels.data());
  EXPECT_LE(std::ranges::count_if(taxels, [](float t) { return t > 0; }), 100);
}

TEST(RecordContactTest, PosesFollowTheArmWithGainAndNoise) {
  Placement placement = Middle();
  placement.pose_gain_error = 0.1;
  placement.pose_noise_m = 0.0002;
  Random random(4);
  const SkinModel skin = IdealSkin();
  const Trial trial =
      RecordContact(SteadyContact(400), skin, placement, random);
  const Eigen::Vector3d normal = LinkNormal(skin.layout, placement.centre);
  double along = 0;
  double square = 0;
  for (size_t i = 10; i < 410; ++i) {
    along += trial.poses[i].position.dot(normal) / 400;
    square += (trial.poses[i].position - 0.0033 * normal).squaredNorm() / 1200;
  }
  EXPECT_NEAR(along, 0.0033, 4e-5);
  EXPECT_NEAR(std::sqrt(square), 0.0002, 2e-5);
}

// Far from its start a free arm moves as fast as its equilibrium point.
TEST(RecordContactTest, PosesBeforeTheTouchFollowTheApproach) {
  SimulatedContact contact = SteadyContact(1);
  contact.spec.robot = {.stiffness = 2050, .velocity = 0.02};
  Placement placement = Middle();
  placement.pose_gain_error = 0.1;
  placement.lead_in_frames = 30;
  const SkinModel skin = IdealSkin();
  const Eigen::Vector3d normal = LinkNormal(skin.layout, placement.centre);
  Random random(6);
  for (const double approach_s : {0.0, 0.9}) {
    contact.spec.approach_s = approach_s;
    const Trial trial = RecordContact(contact, skin, placement, random);
    const double speed = approach_s > 0 ? 0.02 : 0;
    for (int i = 0; i < 30; ++i) {
      EXPECT_NEAR(trial.poses[i].position.dot(normal),
                  1.1 * speed * (i - 29) / 100, 1e-9);
    }
  }
}

TEST(RecordContactTest, NoiseAndStepsHaveTheSizesOfTheSkin) {
  SkinModel skin = IdealSkin();
  skin.noise_n = 0.1;
  skin.step_n = 0.001;
  Placement placement = Middle();
  placement.lead_in_frames = 100;
  Random random(7);
  const Trial trial = RecordContact(SteadyContact(1), skin, placement, random);
  EXPECT_EQ(trial.taxels.scale, 0.001);
  // Readings end at 0, so half of a Gaussian is left: mean square s^2 / 2.
  double square = 0;
  for (int i = 0; i < 100 * 384; ++i) {
    square += std::pow(trial.taxels.u16[i] * 0.001, 2) / (100 * 384);
  }
  EXPECT_NEAR(std::sqrt(2 * square), 0.1, 0.002);
}

TEST(RecordContactTest, ReadingsEndAtTheLargestStep) {
  SkinModel skin = IdealSkin();
  skin.step_n = 1e-6;
  Random random(1);
  const Trial trial = RecordContact(SteadyContact(1), skin, Middle(), random);
  EXPECT_EQ(*std::ranges::max_element(trial.taxels.u16), 65535);
}

TEST(RecordContactTest, SameSeedSameBitsOtherSeedOtherPlaceAndNoise) {
  const SkinModel skin = *SkinModelNamed("measured");
  const auto record = [&](uint64_t seed) {
    Random random(seed);
    const Placement placement = DrawPlacement(skin.layout, random);
    return RecordContact(SteadyContact(5), skin, placement, random);
  };
  const Trial a = record(7);
  const Trial b = record(7);
  const Trial c = record(8);
  EXPECT_EQ(a.taxels.u16, b.taxels.u16);
  EXPECT_EQ(a.poses.back().position, b.poses.back().position);
  EXPECT_NE(a.taxels.u16, c.taxels.u16);
  EXPECT_NE(a.poses.back().position, c.poses.back().position);
}

TEST(DetectableTest, MaskedTaxelsFeelNothing) {
  SkinModel skin = IdealSkin();
  Random random(1);
  const Trial trial = RecordContact(SteadyContact(50), skin, Middle(), random);
  EXPECT_TRUE(Detectable(trial, skin.layout));
  skin.layout.mask.assign(skin.layout.taxels(), 0);
  EXPECT_FALSE(Detectable(trial, skin.layout));
}

TEST(SkinModelTest, AnUnknownNameListsTheSkins) {
  const auto skin = SkinModelNamed("best");
  EXPECT_EQ(ReasonOf(skin.status()), "INVALID_CONFIG");
  EXPECT_THAT(std::string(skin.status().message()),
              HasSubstr("paper, good or measured"));
}

// Every seventh contact of the paper's set; `trainctl simulate --protocol=paper
// --skin=paper` counts all of them.
TEST(SkinModelTest, ThePapersSkinFeelsThePapersContacts) {
  const SkinModel skin = *SkinModelNamed("paper");
  const auto specs = TrialSpecs(PaperGrid().Conditions());
  for (size_t i = 0; i < specs.size(); i += 7) {
    const auto contact = SimulateContact(specs[i]);
    ASSERT_TRUE(contact.ok());
    Random random(i);
    const Placement placement = DrawPlacement(skin.layout, random);
    EXPECT_TRUE(Detectable(RecordContact(*contact, skin, placement, random),
                           skin.layout))
        << contact->Metadata().object;
  }
}

// Every eleventh contact of the paper's set; `trainctl simulate
// --protocol=paper --skin=good` counts all of them.
TEST(SkinModelTest, LightTouchHalvesWhatIsNeverFelt) {
  for (const char* const name : {"good", "measured"}) {
    const SkinModel skin = *SkinModelNamed(name);
    SkinLayout single = skin.layout;
    single.light_touch.reset();
    int never = 0;
    int never_by_taxel = 0;
    const auto specs = TrialSpecs(PaperGrid().Conditions());
    for (size_t i = 0; i < specs.size(); i += 11) {
      const auto contact = SimulateContact(specs[i]);
      ASSERT_TRUE(contact.ok());
      Random random(i);
      const Placement placement = DrawPlacement(skin.layout, random);
      const Trial trial = RecordContact(*contact, skin, placement, random);
      never += !Detectable(trial, skin.layout);
      // Above its strays, as without light touch it has to be.
      if (skin.stray_max_n > 0) {
        single.contact_threshold = 0.12;
        single.onset_threshold = 0.15;
      }
      never_by_taxel += !Detectable(trial, single);
    }
    EXPECT_LE(never, 0.6 * never_by_taxel) << name;
    EXPECT_GT(never, 0) << name;
  }
}

// Demonstrations need contacts of all classes from robots never trained on.
TEST(SkinModelTest, AnUnseenRobotFeelsContactsOfAllClasses) {
  const SkinModel skin = *SkinModelNamed("good");
  std::vector<std::string> labels;
  for (const TrialSpec& spec : TrialSpecs({{900, 0.012, kPaperGoal}})) {
    if (spec.number % 14 != 0) continue;
    const auto contacts = SimulateWithTwin(spec);
    ASSERT_TRUE(contacts.ok()) << contacts.status();
    for (const SimulatedContact& contact : *contacts) {
      Random random(contact.spec.number);
      const Placement placement = DrawPlacement(skin.layout, random);
      const Trial trial = RecordContact(contact, skin, placement, random);
      EXPECT_EQ(trial.condition, "k900-v0.012");
      if (Detectable(trial, skin.layout)) labels.push_back(trial.label);
    }
  }
  for (const char* label : {"HU", "HM", "SU", "SM"}) {
    EXPECT_GE(std::count(labels.begin(), labels.end(), label), 2) << label;
  }
}

// No contact begins on an untouched skin.
TEST(SkinModelTest, AnUntouchedSkinFeelsNothing) {
  for (const char* const name : {"paper", "good", "measured"}) {
    const SkinModel skin = *SkinModelNamed(name);
    Random random(5);
    SimulatedContact nothing = SteadyContact(0);
    Placement placement = Middle();
    placement.lead_in_frames = 500;
    for (int i = 0; i < 10; ++i) {
      EXPECT_FALSE(Detectable(RecordContact(nothing, skin, placement, random),
                              skin.layout))
          << name;
    }
  }
}

}  // namespace
}  // namespace tactus::internal
