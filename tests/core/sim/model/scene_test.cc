#include "core/sim/model/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/errors.h"
#include "core/sim/model/equilibrium.h"
#include "core/sim/model/materials.h"
#include "gtest/gtest.h"
#include "tests/support/find_material.h"

namespace tactus::internal {
namespace {

ContactScene GoodScene() {
  ContactScene scene;
  scene.actuator_damping = CriticalDamping(543, kCodyArmMass);
  scene.object_mass_kg = 0.1;
  scene.object_stiffness = 1e4;
  scene.mu_static = 0.5;
  scene.mu_kinetic = 0.4;
  return scene;
}

TEST(EquilibriumLegsTest, ThePointComesBackFromWhereverItTurns) {
  ContactScene scene = GoodScene();
  scene.lead_m = 0.004;
  scene.retreat_speed_m_s = 0.03;
  // 3 s to the goal.
  for (const double turn : {1.0, 4.0}) {
    scene.retreat_after_s = turn;
    const auto legs = EquilibriumLegs(scene);
    ASSERT_EQ(legs.size(), turn < 3 ? 2 : 3);
    double begin = 0;
    for (const EquilibriumLeg& leg : legs) {
      const double end = std::min(leg.end_s, 6.0);
      for (const double t : {begin, (begin + end) / 2, end}) {
        const double forward =
            std::min(0.004 + 0.005 * std::min(t, turn), 0.019);
        EXPECT_NEAR(leg.PositionAt(t), forward - 0.03 * std::max(t - turn, 0.0),
                    1e-15);
      }
      begin = end;
    }
    EXPECT_EQ(begin, 6);
  }
}

TEST(ValidateSceneTest, EachBadFieldIsNamed) {
  ASSERT_TRUE(Validate(GoodScene()).ok());
  struct Case {
    const char* field;
    void (*spoil)(ContactScene&);
  };
  const Case cases[] = {
      {"scene.arm_mass_kg", [](ContactScene& s) { s.arm_mass_kg = 0; }},
      {"scene.arm_mass_kg",
       [](ContactScene& s) { s.arm_mass_kg = std::nan(""); }},
      {"scene.actuator_stiffness",
       [](ContactScene& s) { s.actuator_stiffness = -543; }},
      {"scene.actuator_damping",
       [](ContactScene& s) { s.actuator_damping = -1; }},
      {"scene.velocity_m_s", [](ContactScene& s) { s.velocity_m_s = 0; }},
      {"scene.goal_m", [](ContactScene& s) { s.goal_m = -0.019; }},
      {"scene.touch_speed_m_s",
       [](ContactScene& s) { s.touch_speed_m_s = -0.001; }},
      {"scene.lead_m", [](ContactScene& s) { s.lead_m = 2 * s.goal_m; }},
      {"scene.retreat_after_s",
       [](ContactScene& s) { s.retreat_after_s = std::nan(""); }},
      {"scene.retreat_after_s",
       [](ContactScene& s) { s.retreat_after_s = -1; }},
      {"scene.retreat_speed_m_s",
       [](ContactScene& s) { s.retreat_after_s = 1; }},
      {"scene.object_mass_kg", [](ContactScene& s) { s.object_mass_kg = 0; }},
      {"scene.object_stiffness",
       [](ContactScene& s) {
         s.object_stiffness = std::numeric_limits<double>::infinity();
       }},
      {"scene.mu_static", [](ContactScene& s) { s.mu_static = 0; }},
      {"scene.mu_kinetic", [](ContactScene& s) { s.mu_kinetic = 0.6; }},
      {"scene.duration_s", [](ContactScene& s) { s.duration_s = 1e9; }},
  };
  for (const Case& c : cases) {
    ContactScene scene = GoodScene();
    c.spoil(scene);
    const absl::Status status = Validate(scene);
    EXPECT_EQ(ReasonOf(status), "INVALID_SCENE") << c.field;
    EXPECT_EQ(InfoOf(status).metadata().at("field"), c.field);
  }
}

TEST(MaterialsTest, TheTableHasThirteenFindableMaterials) {
  EXPECT_EQ(Materials().size(), 13);
  ASSERT_NE(FindMaterial("steel"), nullptr);
  EXPECT_EQ(FindMaterial("steel")->youngs_modulus, 2e11);
  EXPECT_EQ(FindMaterial("glass")->glass.mu_static, 0.95);
  EXPECT_EQ(FindMaterial("cheese"), nullptr);
  for (const Material& m : Materials()) {
    EXPECT_GE(m.wood.mu_static, m.wood.mu_kinetic) << m.name;
    EXPECT_GE(m.glass.mu_static, m.glass.mu_kinetic) << m.name;
    EXPECT_LE(m.poisson_ratio, 0.5) << m.name;
  }
}

// Equations 8 and 8a of the paper by hand.
TEST(MaterialsTest, CubeMassAndStiffness) {
  const Cube cube = {*FindMaterial("steel"), 0.1, Surface::kGlass};
  EXPECT_NEAR(cube.Mass(), 7.85, 1e-12);
  EXPECT_NEAR(cube.Stiffness(), 4e10, 1);
  EXPECT_EQ(cube.TableFriction().mu_kinetic, 0.12);
}

// Against the equation of the free arm in small steps.
TEST(SetApproachTest, TheArmHasMovedFreely) {
  ContactScene scene = GoodScene();
  for (const double seconds : {0.0, 0.02, 0.1, 0.7}) {
    SetApproach(seconds, scene);
    constexpr int kSteps = 100'000;
    const double dt = seconds / kSteps;
    double x = 0;
    double v = 0;
    for (int i = 0; i < kSteps; ++i) {
      // Midpoint rule.
      const auto acceleration = [&](double t, double at, double speed) {
        return (scene.actuator_stiffness * (scene.velocity_m_s * t - at) +
                scene.actuator_damping * (scene.velocity_m_s - speed)) /
               scene.arm_mass_kg;
      };
      const double t = i * dt;
      const double middle_x = x + dt / 2 * v;
      const double middle_v = v + dt / 2 * acceleration(t, x, v);
      x += dt * middle_v;
      v += dt * acceleration(t + dt / 2, middle_x, middle_v);
    }
    EXPECT_NEAR(scene.touch_speed_m_s, v, 1e-9) << seconds;
    EXPECT_NEAR(scene.lead_m, scene.velocity_m_s * seconds - x, 1e-9);
    EXPECT_NEAR(ApproachPosition(seconds, seconds, scene), -x, 1e-9);
  }
}

TEST(SetApproachTest, PositionsBeforeTheTouchLeadToIt) {
  ContactScene scene = GoodScene();
  constexpr double kApproach = 0.3;
  SetApproach(kApproach, scene);
  const auto at = [&](double before) {
    return ApproachPosition(kApproach, before, scene);
  };
  EXPECT_EQ(at(0), 0);
  EXPECT_NEAR(-at(1e-6) / 1e-6, scene.touch_speed_m_s, 1e-6);
  // It begins like an approach of half the time.
  ContactScene shorter = scene;
  SetApproach(kApproach / 2, shorter);
  EXPECT_NEAR(at(kApproach / 2) - at(kApproach),
              scene.velocity_m_s * kApproach / 2 - shorter.lead_m, 1e-15);
  // It rests before it starts.
  EXPECT_EQ(at(0.31), at(kApproach));
  EXPECT_EQ(ApproachPosition(0, 1, scene), 0);
}

}  // namespace
}  // namespace tactus::internal
