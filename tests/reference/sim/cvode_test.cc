#include "tests/reference/sim/cvode.h"

#include <algorithm>
#include <cmath>

#include "core/base/errors.h"
#include "core/sim/model/materials.h"
#include "gtest/gtest.h"
#include "tests/support/find_material.h"

namespace tactus::internal {
namespace {

ContactScene SceneFor(const char* material, double edge, Surface surface,
                      double stiffness, double velocity) {
  const Cube cube = {*FindMaterial(material), edge, surface};
  ContactScene scene;
  scene.actuator_stiffness = stiffness;
  scene.actuator_damping = CriticalDamping(stiffness, scene.arm_mass_kg);
  scene.velocity_m_s = velocity;
  scene.object_mass_kg = cube.Mass();
  scene.object_stiffness = cube.Stiffness();
  scene.mu_static = cube.TableFriction().mu_static;
  scene.mu_kinetic = cube.TableFriction().mu_kinetic;
  return scene;
}

double Actuator(const ContactScene& s, double t, double x, double v) {
  const bool ramping = t < s.RampEnd();
  return s.actuator_stiffness *
             ((ramping ? s.velocity_m_s * t : s.goal_m) - x) +
         s.actuator_damping * ((ramping ? s.velocity_m_s : 0) - v);
}

// The model written down a second time, with a fixed-step 4th-order
// Runge-Kutta: friction is chosen at the start of each step.
class RungeKutta {
 public:
  explicit RungeKutta(const ContactScene& scene) : s_(scene) {}

  void Step(double h) {
    const double force = Force(y_[0], y_[2]);
    if (y_[3] <= 0) {
      y_[3] = 0;
      sliding_ = !s_.fixed && force > s_.StaticLimit();
    }
    double k1[4], k2[4], k3[4], k4[4], z[4];
    Slope(t_, y_, k1);
    for (int i = 0; i < 4; ++i) z[i] = y_[i] + h / 2 * k1[i];
    Slope(t_ + h / 2, z, k2);
    for (int i = 0; i < 4; ++i) z[i] = y_[i] + h / 2 * k2[i];
    Slope(t_ + h / 2, z, k3);
    for (int i = 0; i < 4; ++i) z[i] = y_[i] + h * k3[i];
    Slope(t_ + h, z, k4);
    for (int i = 0; i < 4; ++i) {
      y_[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
    }
    t_ += h;
  }
  double x_arm() const { return y_[0]; }
  double x_uobj() const { return y_[2]; }
  double force() const { return Force(y_[0], y_[2]); }

 private:
  double Force(double x_arm, double x_uobj) const {
    return std::max(0.0, s_.object_stiffness * (x_arm - x_uobj));
  }
  void Slope(double t, const double* y, double* d) const {
    const double force = Force(y[0], y[2]);
    d[0] = y[1];
    d[1] = (Actuator(s_, t, y[0], y[1]) - force) / s_.arm_mass_kg;
    d[2] = sliding_ ? y[3] : 0;
    d[3] = sliding_ ? (force - s_.KineticFriction()) / s_.object_mass_kg : 0;
  }

  const ContactScene& s_;
  double t_ = 0;
  double y_[4] = {};
  bool sliding_ = false;
};

struct Case {
  const char* material;
  double edge;
  double velocity;
  bool slides;
  double relative_tolerance = SolverOptions().relative_tolerance;
};

class AgainstRungeKutta : public testing::TestWithParam<Case> {};

// Position within 2 um and force within 1 % of its peak: at the default
// tolerances for objects too soft to ring, at a tighter one for a hard cube.
TEST_P(AgainstRungeKutta, TrajectoriesAgree) {
  const Case c = GetParam();
  ContactScene scene =
      SceneFor(c.material, c.edge, Surface::kWood, 543, c.velocity);
  scene.duration_s = 2;
  SolverOptions options;
  options.sample_rate_hz = 1000;
  options.relative_tolerance = c.relative_tolerance;
  const auto run = IntegrateCvode(scene, options);
  ASSERT_TRUE(run.ok()) << run.status();
  ASSERT_EQ(run->samples.size(), 2001);
  EXPECT_EQ(run->moved, c.slides);
  RungeKutta reference(scene);
  double peak = 0;
  double worst_force = 0;
  double worst_position = 0;
  for (size_t i = 1; i < run->samples.size(); ++i) {
    for (int step = 0; step < 500; ++step) reference.Step(2e-6);
    const TrajectorySample& sample = run->samples[i];
    peak = std::max(peak, reference.force());
    worst_force =
        std::max(worst_force, std::abs(sample.force - reference.force()));
    worst_position =
        std::max({worst_position, std::abs(sample.x_arm - reference.x_arm()),
                  std::abs(sample.x_uobj - reference.x_uobj())});
  }
  EXPECT_LT(worst_position, 2e-6);
  EXPECT_LT(worst_force, 0.01 * peak);
}

INSTANTIATE_TEST_SUITE_P(SoftToHard, AgainstRungeKutta,
                         testing::Values(Case{"fat", 0.0944, 0.02, false},
                                         Case{"soft-foam", 0.2, 0.02, true},
                                         Case{"muscle", 0.0733, 0.02, true},
                                         Case{"muscle", 0.2, 0.005, false},
                                         Case{"natural-rubber", 0.1, 0.02, true,
                                              1e-6}));

// While the object is stuck, the model is a damped oscillator pulled by a
// ramp: m x'' + b x' + (k + k_obj) x = k v t + b v.
TEST(IntegrateCvodeTest, StuckObjectFollowsTheClosedForm) {
  for (double object_stiffness : {500.0, 2e4, 1e6}) {
    ContactScene scene = SceneFor("steel", 0.2, Surface::kWood, 2050, 0.005);
    scene.object_stiffness = object_stiffness;
    scene.duration_s = 2;
    SolverOptions options;
    options.relative_tolerance = 1e-8;
    options.force_tolerance = 1e-9;
    options.velocity_tolerance = 1e-10;
    const auto run = IntegrateCvode(scene, options);
    ASSERT_TRUE(run.ok()) << run.status();
    const double m = scene.arm_mass_kg;
    const double b = scene.actuator_damping;
    const double v = scene.velocity_m_s;
    const double k = scene.actuator_stiffness + object_stiffness;
    const double slope = scene.actuator_stiffness * v / k;
    const double offset = b * (v - slope) / k;
    const double decay = b / (2 * m);
    const double rate = std::sqrt(k / m - decay * decay);
    const double in_phase = -offset;
    const double quadrature = (decay * in_phase - slope) / rate;
    double peak = 0;
    for (const TrajectorySample& sample : run->samples) {
      peak = std::max(peak, sample.force);
    }
    for (size_t i = 0; i < run->samples.size(); ++i) {
      const double t = static_cast<double>(i) / run->sample_rate_hz;
      const double x = slope * t + offset +
                       std::exp(-decay * t) * (in_phase * std::cos(rate * t) +
                                               quadrature * std::sin(rate * t));
      ASSERT_NEAR(run->samples[i].force, object_stiffness * x, 1e-3 * peak)
          << i << " at " << object_stiffness << " N/m";
    }
    EXPECT_FALSE(run->moved);
  }
}

// Work done by the actuator = energy of arm, object and contact + friction.
TEST(IntegrateCvodeTest, EnergyIsBalanced) {
  ContactScene scene =
      SceneFor("natural-rubber", 0.05, Surface::kWood, 543, 0.02);
  scene.duration_s = 2;
  SolverOptions options;
  options.relative_tolerance = 1e-7;
  options.force_tolerance = 1e-7;
  options.velocity_tolerance = 1e-9;
  options.sample_rate_hz = 20000;
  const auto run = IntegrateCvode(scene, options);
  ASSERT_TRUE(run.ok()) << run.status();
  ASSERT_TRUE(run->moved);
  double work = 0;
  double last_power = 0;
  for (size_t i = 1; i < run->samples.size(); ++i) {
    const TrajectorySample& s = run->samples[i];
    const double t = static_cast<double>(i) / run->sample_rate_hz;
    const double power = Actuator(scene, t, s.x_arm, s.v_arm) * s.v_arm;
    work += (power + last_power) / 2 / run->sample_rate_hz;
    last_power = power;
    const double stored = 0.5 * scene.arm_mass_kg * s.v_arm * s.v_arm +
                          0.5 * scene.object_mass_kg * s.v_uobj * s.v_uobj +
                          0.5 * s.force * s.force / scene.object_stiffness;
    const double friction = scene.KineticFriction() * s.x_uobj;
    ASSERT_NEAR(work, stored + friction, 2e-3 * work + 1e-7) << t;
  }
}

// Newton's second law for the arm, which holds through every impact:
// m v = integral of actuator force - impulse of the contact.
TEST(IntegrateCvodeTest, ImpulseCountsEveryImpact) {
  const ContactScene scenes[] = {
      SceneFor("abs-plastic", 0.0311, Surface::kWood, 543, 0.02),
      SceneFor("steel", 0.0311, Surface::kWood, 543, 0.02),
      SceneFor("polymer-foam", 0.0311, Surface::kWood, 543, 0.02),
      // Heavy objects: long rests, then a slip.
      SceneFor("glass", 0.2, Surface::kWood, 2050, 0.005),
      SceneFor("muscle", 0.0944, Surface::kWood, 543, 0.005),
  };
  for (const ContactScene& scene : scenes) {
    const auto run = IntegrateCvode(scene, {});
    ASSERT_TRUE(run.ok()) << run.status();
    ASSERT_TRUE(run->moved);
    double spring = 0;
    for (size_t i = 1; i < run->samples.size(); ++i) {
      const double t = (i - 0.5) / run->sample_rate_hz;
      const double x = (run->samples[i].x_arm + run->samples[i - 1].x_arm) / 2;
      spring += scene.actuator_stiffness / run->sample_rate_hz *
                (std::min(t * scene.velocity_m_s, scene.goal_m) - x);
    }
    const TrajectorySample& last = run->samples.back();
    const double impulse =
        spring + scene.actuator_damping * (scene.goal_m - last.x_arm) -
        scene.arm_mass_kg * last.v_arm;
    // The arm's own law amplifies the error of its position.
    EXPECT_NEAR(last.impulse, impulse, 0.002 * impulse + 5e-5)
        << scene.object_mass_kg << " kg";
  }
}

TEST(IntegrateCvodeTest, TheForceOnlyPushesAndTheObjectOnlyAdvances) {
  for (const char* material : {"abs-plastic", "light-foam", "ceramic"}) {
    const auto run = IntegrateCvode(
        SceneFor(material, 0.01, Surface::kGlass, 2050, 0.02), {});
    ASSERT_TRUE(run.ok()) << run.status();
    EXPECT_GT(run->events.contacts_lost, 0) << material;
    EXPECT_EQ(run->samples.size(), 10001);
    for (size_t i = 1; i < run->samples.size(); ++i) {
      const TrajectorySample& now = run->samples[i];
      const TrajectorySample& before = run->samples[i - 1];
      ASSERT_GE(now.force, 0);
      const bool apart = now.x_arm < now.x_uobj - 1e-12;
      ASSERT_FALSE(apart && now.force > 0);
      ASSERT_GE(now.impulse, before.impulse - 1e-9);
      ASSERT_GE(now.x_uobj, before.x_uobj - 1e-9);
      ASSERT_GE(now.contact_time, before.contact_time);
      ASSERT_LE(now.contact_time - before.contact_time, 0.0005 + 1e-12);
    }
  }
}

TEST(IntegrateCvodeTest, AFixedObjectStaysPutExactly) {
  for (const char* material : {"fat", "light-foam", "steel"}) {
    ContactScene scene = SceneFor(material, 0.01, Surface::kWood, 543, 0.02);
    ASSERT_TRUE(IntegrateCvode(scene, {})->moved) << material;
    scene.fixed = true;
    const auto run = IntegrateCvode(scene, {});
    ASSERT_TRUE(run.ok()) << run.status();
    EXPECT_FALSE(run->moved);
    for (const TrajectorySample& sample : run->samples) {
      ASSERT_EQ(sample.x_uobj, 0);
      ASSERT_EQ(sample.v_uobj, 0);
    }
    // At rest, the two springs share the goal.
    const double k = scene.object_stiffness;
    EXPECT_NEAR(run->samples.back().force, 543 * k / (543 + k) * scene.goal_m,
                1e-3)
        << material;
  }
}

TEST(IntegrateCvodeTest, TooManyEventsOrStepsAreAnErrorNotAStall) {
  const ContactScene scene =
      SceneFor("abs-plastic", 0.01, Surface::kWood, 543, 0.02);
  SolverOptions events;
  events.max_events = 1;
  EXPECT_EQ(ReasonOf(IntegrateCvode(scene, events).status()),
            "NUMERICAL_FAILURE");
  SolverOptions steps;
  steps.max_steps = 100;
  EXPECT_EQ(ReasonOf(IntegrateCvode(scene, steps).status()),
            "NUMERICAL_FAILURE");
}

TEST(IntegrateCvodeTest, EachBadOptionIsNamed) {
  struct BadOption {
    const char* field;
    void (*spoil)(SolverOptions&);
  };
  const BadOption cases[] = {
      {"solver.relative_tolerance",
       [](SolverOptions& o) { o.relative_tolerance = 0; }},
      {"solver.force_tolerance",
       [](SolverOptions& o) { o.force_tolerance = -1; }},
      {"solver.velocity_tolerance",
       [](SolverOptions& o) { o.velocity_tolerance = std::nan(""); }},
      {"solver.position_tolerance",
       [](SolverOptions& o) { o.position_tolerance = 0; }},
      {"solver.sample_rate_hz", [](SolverOptions& o) { o.sample_rate_hz = 0; }},
      {"solver.sample_rate_hz",
       [](SolverOptions& o) { o.sample_rate_hz = 1050; }},
  };
  for (const BadOption& c : cases) {
    SolverOptions options;
    c.spoil(options);
    const auto run = IntegrateCvode(
        SceneFor("muscle", 0.1, Surface::kWood, 543, 0.02), options);
    EXPECT_EQ(ReasonOf(run.status()), "INVALID_SCENE") << c.field;
    EXPECT_EQ(InfoOf(run.status()).metadata().at("field"), c.field);
  }
}

// The lightest and stiffest object a scene may have still ends in time.
TEST(IntegrateCvodeTest, AnExtremeSceneIsFinite) {
  ContactScene scene = SceneFor("steel", 0.01, Surface::kGlass, 2050, 0.02);
  scene.object_mass_kg = 1e-6;
  scene.object_stiffness = 1e15;
  const auto run = IntegrateCvode(scene, {});
  ASSERT_TRUE(run.ok()) << run.status();
  EXPECT_TRUE(run->moved);
  for (const TrajectorySample& sample : run->samples) {
    ASSERT_TRUE(std::isfinite(sample.force + sample.impulse + sample.x_arm));
  }
}

}  // namespace
}  // namespace tactus::internal
