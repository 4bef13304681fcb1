#include "core/sim/model/trial_spec.h"

namespace tactus::internal {

ContactScene SceneOf(const TrialSpec& spec) {
  ContactScene scene;
  scene.actuator_stiffness = spec.robot.stiffness;
  scene.actuator_damping =
      CriticalDamping(spec.robot.stiffness, scene.arm_mass_kg);
  scene.velocity_m_s = spec.robot.velocity;
  scene.goal_m = spec.robot.goal_m;
  scene.object_mass_kg = spec.object.Mass();
  scene.object_stiffness = spec.object.Stiffness();
  const Friction friction = spec.object.TableFriction();
  scene.mu_static = friction.mu_static;
  scene.mu_kinetic = friction.mu_kinetic;
  scene.fixed = spec.fixed;
  scene.duration_s = spec.duration_s;
  scene.retreat_after_s = spec.retreat_after_s;
  scene.retreat_speed_m_s = spec.retreat_speed_m_s;
  SetApproach(spec.approach_s, scene);
  return scene;
}

TrialSpec FixedTwin(const TrialSpec& spec) {
  TrialSpec twin = spec;
  twin.fixed = true;
  twin.number = spec.number + 1;
  return twin;
}

}  // namespace tactus::internal
