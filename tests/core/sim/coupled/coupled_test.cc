#include "core/sim/coupled/coupled.h"

#include <cmath>

#include "core/base/errors.h"
#include "core/sim/exact/exact.h"
#include "gtest/gtest.h"
#include "tests/core/sim/random_scenes.h"
#include "tests/reference/sim/coupled_cvode.h"

namespace tactus::internal {
namespace {

// A scene of 0.3 s whose contact rings so slowly that steps can follow.
ContactScene SlowScene(Random& random, double ringing) {
  while (true) {
    ContactScene scene = RandomScene(random);
    scene.duration_s = 0.3;
    if (RingingRate(scene) < ringing) return scene;
  }
}

// With one object, the closed form; every second arm lifts off.
TEST(IntegrateCoupledTest, OneObjectIsThatOfTheExactMethod) {
  Random random(21);
  int64_t events = 0;
  int compared = 0;
  while (compared < 60) {
    ContactScene scene = SlowScene(random, 2e4);
    if (compared % 2 == 1) SetRetreat(random, scene);
    const auto exact = IntegrateExact(scene, {.skip_tolerance = 0});
    ASSERT_TRUE(exact.ok()) << exact.status();
    if (exact->events.Total() > 60) continue;
    ++compared;
    const auto runs =
        IntegrateCoupled({.arm = scene, .objects = {ObjectOf(scene)}}, {});
    ASSERT_TRUE(runs.ok()) << runs.status();
    const Trajectory& run = runs->front();
    ASSERT_EQ(run.samples.size(), exact->samples.size());
    EXPECT_EQ(run.moved, exact->moved);
    EXPECT_EQ(run.events.Total(), exact->events.Total()) << compared;
    events = std::max(events, run.events.Total());
    const double impulse = exact->samples.back().impulse;
    for (size_t i = 0; i < run.samples.size(); ++i) {
      const TrajectorySample& got = run.samples[i];
      const TrajectorySample& want = exact->samples[i];
      ASSERT_NEAR(got.x_arm, want.x_arm, 1e-6 * scene.goal_m) << compared;
      ASSERT_NEAR(got.x_uobj, want.x_uobj, 1e-6 * scene.goal_m) << compared;
      ASSERT_NEAR(got.impulse, want.impulse, 1e-6 * impulse) << compared;
      ASSERT_NEAR(got.contact_time, want.contact_time, 1e-6) << compared;
    }
  }
  EXPECT_GT(events, 30);
}

// One to three objects at their own distances, against CVODE.
TEST(IntegrateCoupledTest, SeveralObjectsAreThoseOfCvode) {
  Random random(22);
  int touched = 0;
  int moved = 0;
  for (int n = 0; n < 45; ++n) {
    CoupledScene scene;
    scene.arm = SlowScene(random, 3e3);
    scene.arm.velocity_m_s = LogUniform(random, 0.02, 0.1);
    scene.arm.actuator_damping =
        CriticalDamping(scene.arm.actuator_stiffness, scene.arm.arm_mass_kg);
    if (n % 2 == 1) SetRetreat(random, scene.arm);
    for (int i = 0; i <= n % 3; ++i) {
      ContactScene other = SlowScene(random, 3e3);
      scene.objects.push_back(ObjectOf(other));
      if (i > 0) {
        scene.objects.back().distance_m =
            scene.arm.goal_m * random.Uniform(0, 0.3);
      }
    }
    const auto runs = IntegrateCoupled(scene, {});
    ASSERT_TRUE(runs.ok()) << runs.status();
    const auto reference = IntegrateCoupledCvode(scene, 2000);
    ASSERT_TRUE(reference.ok()) << reference.status();
    for (size_t i = 0; i < runs->size(); ++i) {
      const Trajectory& run = (*runs)[i];
      const Trajectory& want = (*reference)[i];
      ASSERT_EQ(run.samples.size(), want.samples.size());
      touched += i > 0 && run.events.contacts_made > 0;
      moved += run.moved;
      EXPECT_EQ(run.moved, want.moved) << n << " object " << i;
      EXPECT_EQ(run.events.Total(), want.events.Total())
          << n << " object " << i;
      for (size_t t = 0; t < run.samples.size(); ++t) {
        ASSERT_NEAR(run.samples[t].x_arm, want.samples[t].x_arm,
                    1e-6 * scene.arm.goal_m)
            << n << " sample " << t;
        ASSERT_NEAR(run.samples[t].x_uobj, want.samples[t].x_uobj,
                    1e-6 * scene.arm.goal_m)
            << n << " object " << i << " sample " << t;
      }
    }
  }
  EXPECT_GT(touched, 20);
  EXPECT_GT(moved, 20);
}

// An object that slips and stops at one force must not do so for ever.
TEST(IntegrateCoupledTest, FrictionMayBeTheSameAtRest) {
  Random random(25);
  int slips = 0;
  for (int n = 0; n < 20; ++n) {
    ContactScene scene = SlowScene(random, 5e3);
    scene.mu_kinetic = scene.mu_static;
    const auto exact = IntegrateExact(scene, {.skip_tolerance = 0});
    const auto runs =
        IntegrateCoupled({.arm = scene, .objects = {ObjectOf(scene)}}, {});
    ASSERT_TRUE(exact.ok() && runs.ok()) << exact.status() << runs.status();
    slips += runs->front().events.slips;
    EXPECT_NEAR(runs->front().samples.back().x_uobj,
                exact->samples.back().x_uobj, 1e-6 * scene.goal_m)
        << n;
  }
  EXPECT_GT(slips, 5);
}

// At rest, fixed objects share the arm's force by their stiffness.
TEST(IntegrateCoupledTest, FixedObjectsShareTheForce) {
  ContactScene scene;
  scene.actuator_damping = CriticalDamping(543, scene.arm_mass_kg);
  scene.object_mass_kg = 1;
  scene.object_stiffness = 1000;
  scene.mu_static = scene.mu_kinetic = 0.5;
  scene.fixed = true;
  CoupledScene both = {.arm = scene,
                       .objects = {ObjectOf(scene), ObjectOf(scene)}};
  both.arm.velocity_m_s = 0.05;
  both.arm.duration_s = 20;
  both.objects[1].stiffness = 3000;
  both.objects[1].distance_m = 0.002;
  const auto runs = IntegrateCoupled(both, {});
  ASSERT_TRUE(runs.ok()) << runs.status();
  // 543 (0.019 - x) = 1000 x + 3000 (x - 0.002).
  const double x = (543 * 0.019 + 6) / 4543;
  EXPECT_NEAR((*runs)[0].samples.back().x_arm, x, 1e-9);
  EXPECT_NEAR((*runs)[0].samples.back().force, 1000 * x, 1e-6);
  EXPECT_NEAR((*runs)[1].samples.back().force, 3000 * (x - 0.002), 1e-6);
}

// Twins slip, stop and lift off at the same instants, as one of both masses.
TEST(IntegrateCoupledTest, TwinsAreOneObjectOfBothMasses) {
  Random random(23);
  for (int n = 0; n < 20; ++n) {
    ContactScene scene = SlowScene(random, 5e3);
    scene.fixed = false;
    ContactScene twin = scene;
    twin.object_mass_kg /= 2;
    twin.object_stiffness /= 2;
    const auto one =
        IntegrateCoupled({.arm = scene, .objects = {ObjectOf(scene)}}, {});
    const auto two = IntegrateCoupled(
        {.arm = scene, .objects = {ObjectOf(twin), ObjectOf(twin)}}, {});
    ASSERT_TRUE(one.ok() && two.ok()) << one.status() << two.status();
    for (const Trajectory& run : *two) {
      EXPECT_NEAR(run.samples.back().x_uobj, one->front().samples.back().x_uobj,
                  1e-6 * scene.goal_m)
          << n;
    }
  }
}

TEST(IntegrateCoupledTest, EachBadFieldIsNamed) {
  Random random(24);
  const ContactScene scene = SlowScene(random, 1e3);
  const CoupledScene good = {.arm = scene, .objects = {ObjectOf(scene)}};
  CoupledScene none = good;
  none.objects.clear();
  CoupledScene many = good;
  many.objects.resize(5, good.objects.front());
  CoupledScene behind = good;
  behind.objects.front().distance_m = -1e-3;
  CoupledScene light = good;
  light.objects.front().mass_kg = 0;
  const struct {
    CoupledScene scene;
    const char* field;
  } cases[] = {{none, "scene.objects"},
               {many, "scene.objects"},
               {behind, "scene.distance_m"},
               {light, "scene.object_mass_kg"}};
  for (const auto& c : cases) {
    const auto runs = IntegrateCoupled(c.scene, {});
    EXPECT_EQ(ReasonOf(runs.status()), "INVALID_SCENE") << c.field;
    EXPECT_EQ(InfoOf(runs.status()).metadata().at("field"), c.field);
  }
  EXPECT_EQ(ReasonOf(IntegrateCoupled(good, {.sample_rate_hz = 450}).status()),
            "INVALID_SCENE");
  EXPECT_EQ(ReasonOf(IntegrateCoupled(good, {.max_steps = 3}).status()),
            "NUMERICAL_FAILURE");
}

}  // namespace
}  // namespace tactus::internal
