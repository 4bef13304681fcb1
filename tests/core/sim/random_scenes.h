// File: random_scenes.h
//
// Random contacts for the tests of the simulator, from a much wider range than
// those of the paper.
#pragma once

#include <cmath>

#include "core/base/random.h"
#include "core/sim/model/scene.h"

namespace tactus::internal {

inline double LogUniform(Random& random, double low, double high) {
  return low * std::exp(random.Uniform() * std::log(high / low));
}

// Any arm, object and friction; most objects move, some are fixed.
inline ContactScene RandomScene(Random& random) {
  ContactScene scene;
  scene.arm_mass_kg = LogUniform(random, 0.1, 10);
  scene.actuator_stiffness = LogUniform(random, 50, 5000);
  scene.actuator_damping =
      random.Uniform(0, 2) *
      CriticalDamping(scene.actuator_stiffness, scene.arm_mass_kg);
  scene.velocity_m_s = LogUniform(random, 0.001, 0.1);
  scene.goal_m = LogUniform(random, 0.001, 0.05);
  scene.object_mass_kg = LogUniform(random, 1.6e-5, 63);
  scene.object_stiffness = LogUniform(random, 38, 8e10);
  scene.mu_static = random.Uniform(0.11, 0.95);
  scene.mu_kinetic = scene.mu_static * random.Uniform(0.3, 1);
  scene.fixed = random.Index(10) == 0;
  scene.duration_s = 1;
  return scene;
}

// Lets the arm of `scene` lift off during the scene, often before its goal.
inline void SetRetreat(Random& random, ContactScene& scene) {
  scene.retreat_after_s = random.Uniform(0, scene.duration_s);
  scene.retreat_speed_m_s = LogUniform(random, 0.001, 0.3);
}

// How fast the contact of `scene` rings while the object slides, rad/s.
inline double RingingRate(const ContactScene& scene) {
  return std::sqrt(scene.object_stiffness *
                   (1 / scene.arm_mass_kg + 1 / scene.object_mass_kg));
}

}  // namespace tactus::internal
