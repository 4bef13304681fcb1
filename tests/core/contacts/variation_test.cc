#include "core/contacts/variation.h"

#include <cmath>

#include "core/contacts/varied_contacts.h"
#include "core/sim/exact/exact.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

// Motion is the place in the contact, force its square.
LabelledContact Press(int frames) {
  LabelledContact contact;
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
  const LabelledContact contact = Press(101);
  for (double pace : {0.7, 1.4, 2.0}) {
    const LabelledContact warped = Vary(contact, {.pace = pace}, random);
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
  const LabelledContact contact = Press(101);
  EXPECT_EQ(Vary(contact, {.pace = 2}, random).frames.size(), 50u);
  EXPECT_EQ(Vary(contact, {.pace = 0.5}, random).frames.size(), 101u);
  EXPECT_TRUE(Vary(Press(1), {.pace = 2}, random).frames.empty());
}

TEST(VaryTest, MixesNothingIntoLostTouch) {
  Random random(1);
  LabelledContact contact = Press(9);
  contact.frames.Set(2, {.sample = {}, .touched = false});
  const LabelledContact warped = Vary(contact, {.pace = 0.5}, random);
  EXPECT_TRUE(warped.frames[4].touched);
  EXPECT_EQ(Motion(warped.frames[4]), 1);
  EXPECT_FALSE(warped.frames[5].touched);
  EXPECT_FALSE(warped.frames[6].touched);
  EXPECT_TRUE(warped.frames[7].touched);
}

// An object that slides.
ContactScene SlidingScene() {
  ContactScene scene;
  scene.actuator_damping =
      CriticalDamping(scene.actuator_stiffness, scene.arm_mass_kg);
  scene.object_mass_kg = 0.5;
  scene.object_stiffness = 3e4;
  scene.mu_static = 0.6;
  scene.mu_kinetic = 0.4;
  return scene;
}

// The symmetry that loads rest on, in the contact model itself: a goal, a speed
// and a friction half as large halve all forces and motions.
TEST(VaryTest, LoadIsASymmetryOfTheContactModel) {
  const ContactScene scene = SlidingScene();
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

// The symmetry that stiffnesses rest on: springs, dampers and masses twice as
// large double all forces and leave all motions.
TEST(VaryTest, StiffnessIsASymmetryOfTheContactModel) {
  const ContactScene scene = SlidingScene();
  ContactScene twice = scene;
  for (double* part :
       {&twice.arm_mass_kg, &twice.actuator_stiffness, &twice.actuator_damping,
        &twice.object_mass_kg, &twice.object_stiffness}) {
    *part *= 2;
  }
  const auto run = IntegrateExact(scene, {});
  const auto twice_run = IntegrateExact(twice, {});
  ASSERT_TRUE(run.ok() && twice_run.ok());
  ASSERT_TRUE(run->moved);
  ASSERT_EQ(run->samples.size(), twice_run->samples.size());
  for (size_t i = 0; i < run->samples.size(); i += 100) {
    const TrajectorySample& one = run->samples[i];
    const TrajectorySample& doubled = twice_run->samples[i];
    EXPECT_NEAR(doubled.force, one.force * 2, 1e-6);
    EXPECT_NEAR(doubled.x_arm, one.x_arm, 1e-9);
    EXPECT_NEAR(doubled.x_uobj, one.x_uobj, 1e-9);
  }
}

// Motion and force rise evenly, under noise of 0.01 and 0.1.
LabelledContact NoisyPress(Random& random) {
  LabelledContact contact;
  for (int t = 0; t < 5000; ++t) {
    const double motion = 1 + 0.01 * t + 0.01 * random.Gaussian();
    const double force = 20 + 0.02 * t + 0.1 * random.Gaussian();
    contact.frames.push_back({IdealSample({force, 3, motion})});
    contact.object_motion.push_back(t);
  }
  return contact;
}

std::vector<double> Column(const LabelledContact& contact, Feature feature) {
  std::vector<double> column;
  for (const ContactFrame& frame : contact.frames) {
    column.push_back(frame.sample.features[static_cast<int>(feature)]);
  }
  return column;
}

TEST(VaryTest, ScalesForcesAndMotionsButNotTheNoise) {
  Random random(7);
  const LabelledContact contact = NoisyPress(random);
  const LabelledContact light = Vary(contact, {.load = 0.25}, random);
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

TEST(VaryTest, OtherStiffnessesChangeForcesAlone) {
  Random random(7);
  LabelledContact contact = NoisyPress(random);
  contact.stiffness = 8;
  for (double factor : {0.25, 2.0}) {
    const LabelledContact other = Vary(contact, {.stiffness = factor}, random);
    EXPECT_EQ(other.stiffness, 8 * factor);
    // Noise is never less than the sensor's.
    const auto force = Column(other, Feature::kForce);
    EXPECT_NEAR(NoiseOf(force), 0.1 * std::max(1.0, factor), 0.01);
    for (size_t t = 0; t < force.size(); ++t) {
      EXPECT_NEAR(force[t], factor * (20 + 0.02 * static_cast<double>(t)), 1.2);
      const ContactSample& sample = other.frames[t].sample;
      const ContactSample& before = contact.frames[t].sample;
      EXPECT_EQ(sample.net_force, force[t]);
      EXPECT_EQ(sample.features[1], before.features[1]);
      EXPECT_EQ(sample.features[2], before.features[2]);
      EXPECT_EQ(other.object_motion[t], contact.object_motion[t]);
    }
  }
}

TEST(VaryTest, FindsNoNoiseInWhatChangesEvenlyOrIsTooShort) {
  EXPECT_NEAR(NoiseOf({1, 3, 5, 7, 9}), 0, 1e-12);
  EXPECT_EQ(NoiseOf({1, 5}), 0);
}

// All copies of `contacts`.
std::vector<LabelledContact> DrawVariations(
    const std::vector<const LabelledContact*>& contacts,
    const VariationRange& range, uint64_t seed) {
  const VariedContacts varied(contacts, range, seed);
  std::vector<LabelledContact> drawn;
  for (size_t i = contacts.size(); i < varied.size(); ++i) {
    LabelledContact made;
    drawn.push_back(varied.Get(i, made));
  }
  return drawn;
}

TEST(VariedContactsTest, DrawsFromTheWholeRangeAndTheSameFromTheSameSeed) {
  Random random(3);
  const LabelledContact contact = NoisyPress(random);
  const VariationRange range = {.copies = 40, .pace = 2, .load = 4};
  const auto drawn = DrawVariations({&contact}, range, 5);
  ASSERT_EQ(drawn.size(), 40u);
  size_t shortest = contact.frames.size(), whole = 0;
  double lightest = 1;
  for (const LabelledContact& copy : drawn) {
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

// Contacts of a stiffness and label, with a frame each.
std::vector<LabelledContact> Objects(
    const std::vector<std::pair<double, std::string>>& objects) {
  std::vector<LabelledContact> contacts;
  for (const auto& [stiffness, label] : objects) {
    contacts.push_back(Press(9));
    contacts.back().stiffness = stiffness;
    contacts.back().label = label;
  }
  return contacts;
}

std::vector<LabelledContact> DrawStiffnesses(
    const std::vector<LabelledContact>& contacts) {
  std::vector<const LabelledContact*> pointers;
  for (const LabelledContact& contact : contacts) pointers.push_back(&contact);
  return DrawVariations(pointers, {.copies = 400, .stiffness = 5}, 1);
}

TEST(VariedContactsTest, SoftStaysSoftAndHardStaysHard) {
  const auto contacts =
      Objects({{1, "SU"}, {10, "SU"}, {20, "HU"}, {300, "HU"}});
  const auto drawn = DrawStiffnesses(contacts);
  // The range that the border and a factor of five allow.
  const double least[] = {0.2, 2, 20, 60};
  const double most[] = {5, 10, 100, 1500};
  double softest[] = {1e9, 1e9, 1e9, 1e9};
  double stiffest[] = {0, 0, 0, 0};
  for (size_t i = 0; i < drawn.size(); ++i) {
    const double k = drawn[i].stiffness;
    softest[i % 4] = std::min(softest[i % 4], k);
    stiffest[i % 4] = std::max(stiffest[i % 4], k);
    // Every other copy keeps its stiffness.
    if (i / 4 % 2 == 0) {
      EXPECT_EQ(k, contacts[i % 4].stiffness);
    }
  }
  for (int i = 0; i < 4; ++i) {
    EXPECT_GE(softest[i], least[i] * (1 - 1e-12)) << i;
    EXPECT_LT(softest[i], least[i] * 1.1) << i;
    EXPECT_LE(stiffest[i], most[i] * (1 + 1e-12)) << i;
    EXPECT_GT(stiffest[i], most[i] / 1.1) << i;
  }
}

TEST(VariedContactsTest, StiffnessRestsWhereClassesAreNotOfIt) {
  for (const auto& contacts :
       {Objects({{1, "A"}, {10, "A"}, {5, "B"}, {20, "B"}}),
        Objects({{1, "SU"}, {10, "HU"}, {0, "HU"}})}) {
    const auto drawn = DrawStiffnesses(contacts);
    for (size_t i = 0; i < drawn.size(); ++i) {
      EXPECT_EQ(drawn[i].stiffness, contacts[i % contacts.size()].stiffness);
    }
  }
}

}  // namespace
}  // namespace tactus::internal
