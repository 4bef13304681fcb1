#include "core/eval/variation.h"

#include <cmath>

#include "core/sim/exact.h"
#include "gtest/gtest.h"

namespace tactus {
namespace {

// Motion is the place in the contact, force its square.
Contact Press(int frames) {
  Contact contact;
  contact.label = "HM";
  for (int t = 0; t < frames; ++t) {
    const double x = t;
    contact.frames.push_back({IdealSample({x * x, 1, x})});
    contact.object_motion.push_back(3 * x);
  }
  return contact;
}

double Motion(const ContactFrame& frame) {
  return frame.sample.features[static_cast<int>(Feature::kMotion)];
}

TEST(VaryTest, PlaysTheSameSignalsFasterOrSlower) {
  Random random(1);
  const Contact contact = Press(101);
  for (double pace : {0.7, 1.4, 2.0}) {
    const Contact warped = Vary(contact, {.pace = pace}, random);
    EXPECT_EQ(warped.label, "HM");
    for (size_t t = 0; t < warped.frames.size(); ++t) {
      // The first frame is one after the touch.
      const double place = std::max(0.0, pace * static_cast<double>(t + 1) - 1);
      EXPECT_NEAR(Motion(warped.frames[t]), place, 1e-12);
      EXPECT_NEAR(warped.object_motion[t], 3 * place, 1e-12);
      // A chord of a parabola is at most a quarter above it.
      EXPECT_NEAR(warped.frames[t].sample.net_force, place * place, 0.2501);
    }
  }
}

TEST(VaryTest, LastsAsLongAsThereIsSomethingToPlay) {
  Random random(1);
  const Contact contact = Press(101);
  EXPECT_EQ(Vary(contact, {.pace = 2}, random).frames.size(), 50u);
  EXPECT_EQ(Vary(contact, {.pace = 0.5}, random).frames.size(), 101u);
  EXPECT_TRUE(Vary(Press(1), {.pace = 2}, random).frames.empty());
}

TEST(VaryTest, MixesNothingIntoLostTouch) {
  Random random(1);
  Contact contact = Press(9);
  contact.frames[2] = {.sample = {}, .touched = false};
  const Contact warped = Vary(contact, {.pace = 0.5}, random);
  EXPECT_TRUE(warped.frames[4].touched);
  EXPECT_EQ(Motion(warped.frames[4]), 1);
  EXPECT_FALSE(warped.frames[5].touched);
  EXPECT_FALSE(warped.frames[6].touched);
  EXPECT_TRUE(warped.frames[7].touched);
}

// The symmetry that loads rest on, in the contact model itself: a goal, a speed
// and a friction half as large halve all forces and motions.
TEST(VaryTest, LoadIsASymmetryOfTheContactModel) {
  ContactScene scene;
  scene.actuator_damping =
      CriticalDamping(scene.actuator_stiffness, scene.arm_mass_kg);
  scene.object_mass_kg = 0.5;
  scene.object_stiffness = 3e4;
  scene.mu_static = 0.6;
  scene.mu_kinetic = 0.4;
  ContactScene half = scene;
  half.velocity_m_s /= 2;
  half.goal_m /= 2;
  half.mu_static /= 2;
  half.mu_kinetic /= 2;
  const auto whole_run = IntegrateExact(scene, {});
  const auto half_run = IntegrateExact(half, {});
  ASSERT_TRUE(whole_run.ok() && half_run.ok());
  ASSERT_TRUE(whole_run->moved);
  ASSERT_EQ(whole_run->samples.size(), half_run->samples.size());
  for (size_t i = 0; i < whole_run->samples.size(); i += 100) {
    const TrajectorySample& whole = whole_run->samples[i];
    const TrajectorySample& halved = half_run->samples[i];
    EXPECT_NEAR(halved.force, whole.force / 2, 1e-6);
    EXPECT_NEAR(halved.x_arm, whole.x_arm / 2, 1e-9);
    EXPECT_NEAR(halved.x_uobj, whole.x_uobj / 2, 1e-9);
  }
}

// Motion and force rise evenly, under noise of 0.01 and 0.1.
Contact NoisyPress(Random& random) {
  Contact contact;
  for (int t = 0; t < 5000; ++t) {
    const double motion = 1 + 0.01 * t + 0.01 * random.Gaussian();
    const double force = 20 + 0.02 * t + 0.1 * random.Gaussian();
    contact.frames.push_back({IdealSample({force, 3, motion})});
    contact.object_motion.push_back(t);
  }
  return contact;
}

std::vector<double> Column(const Contact& contact, Feature feature) {
  std::vector<double> column;
  for (const ContactFrame& frame : contact.frames) {
    column.push_back(frame.sample.features[static_cast<int>(feature)]);
  }
  return column;
}

TEST(VaryTest, ScalesForcesAndMotionsButNotTheNoise) {
  Random random(7);
  const Contact contact = NoisyPress(random);
  const Contact light = Vary(contact, {.load = 0.25}, random);
  const auto force = Column(light, Feature::kForce);
  const auto motion = Column(light, Feature::kMotion);
  EXPECT_NEAR(NoiseOf(force), 0.1, 0.005);
  EXPECT_NEAR(NoiseOf(motion), 0.01, 0.0005);
  for (size_t t = 0; t < force.size(); ++t) {
    const double place = static_cast<double>(t);
    EXPECT_NEAR(force[t], 0.25 * (20 + 0.02 * place), 0.6);
    EXPECT_NEAR(motion[t], 0.25 * (1 + 0.01 * place), 0.06);
    EXPECT_EQ(light.frames[t].sample.net_force, force[t]);
    EXPECT_EQ(light.frames[t].sample.features[1],
              contact.frames[t].sample.features[1]);
    EXPECT_EQ(light.object_motion[t], 0.25 * place);
  }
}

TEST(VaryTest, FindsNoNoiseInWhatChangesEvenlyOrIsTooShort) {
  EXPECT_NEAR(NoiseOf({1, 3, 5, 7, 9}), 0, 1e-12);
  EXPECT_EQ(NoiseOf({1, 5}), 0);
}

TEST(DrawVariationsTest, DrawsFromTheWholeRangeAndTheSameFromTheSameSeed) {
  Random random(3);
  const Contact contact = NoisyPress(random);
  const VariationRange range = {.copies = 40, .pace = 2, .load = 4};
  const auto drawn = DrawVariations({&contact}, range, 5);
  ASSERT_EQ(drawn.size(), 40u);
  size_t shortest = contact.frames.size(), whole = 0;
  double lightest = 1;
  for (const Contact& copy : drawn) {
    shortest = std::min(shortest, copy.frames.size());
    if (copy.frames.size() == contact.frames.size()) ++whole;
    // Paces of at least 1/2 and loads of at least 1/4.
    EXPECT_GT(copy.frames.size(), 2490u);
    const double load = copy.frames.front().sample.net_force / 20;
    EXPECT_GT(load, 0.22);
    EXPECT_LT(load, 1.03);
    lightest = std::min(lightest, load);
  }
  EXPECT_LT(shortest, 3000u);
  EXPECT_GT(whole, 10u);
  EXPECT_LT(lightest, 0.35);
  const auto again = DrawVariations({&contact}, range, 5);
  const auto other = DrawVariations({&contact}, range, 6);
  EXPECT_EQ(Column(again[7], Feature::kForce),
            Column(drawn[7], Feature::kForce));
  EXPECT_NE(Column(other[7], Feature::kForce),
            Column(drawn[7], Feature::kForce));
}

}  // namespace
}  // namespace tactus
