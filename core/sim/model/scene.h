// File: scene.h
//
// ContactScene: one press of the arm against one object in the paper's lumped
// element model (Section "Robot and Object Model", eqs. 1 to 7). It begins when
// the arm touches the undeformed object: at rest, as in the paper, or in motion
// after an approach. If it has a retreat, the arm lifts off again.
//
//   ContactScene scene;
//   scene.goal_m = 0.019;
//   TACTUS_RETURN_IF_ERROR(Validate(scene));
//
// Plain data, SI units; safe to share between threads once built.
#pragma once

#include <limits>

#include "absl/status/status.h"

namespace tactus::internal {

inline constexpr double kGravity = 9.81;  // m/s^2
// Mass of the forearm of the robot Cody, kg (paper, "Experimental Setup").
inline constexpr double kCodyArmMass = 1.167;

struct ContactScene {
  double arm_mass_kg = kCodyArmMass;
  // Spring (N/m) and damper (N s/m) between the arm and its equilibrium point.
  double actuator_stiffness = 543;
  double actuator_damping = 0;
  // The equilibrium point moves at `velocity_m_s` to `goal_m` and stays there.
  double velocity_m_s = 0.005;
  double goal_m = 0.019;
  // From this time after the touch on, it moves back at `retreat_speed_m_s`,
  // whether it has reached the goal or not. Infinite: never.
  double retreat_after_s = std::numeric_limits<double>::infinity();
  double retreat_speed_m_s = 0;
  // At the touch: the arm's speed, and how far the equilibrium point is ahead
  // of the arm. Both 0: the arm starts there at rest.
  double touch_speed_m_s = 0;
  double lead_m = 0;
  double object_mass_kg = 0;
  // Stiffness of the object, N/m.
  double object_stiffness = 0;
  // Coulomb friction between object and table; mu_static >= mu_kinetic.
  double mu_static = 0;
  double mu_kinetic = 0;
  // True if the object cannot slide whatever the force.
  bool fixed = false;
  double duration_s = 5;

  // Largest friction at rest and friction while sliding, N.
  double StaticLimit() const { return mu_static * object_mass_kg * kGravity; }
  double KineticFriction() const {
    return mu_kinetic * object_mass_kg * kGravity;
  }
  // Time at which the equilibrium point reaches the goal without a retreat, s.
  double RampEnd() const { return (goal_m - lead_m) / velocity_m_s; }
};

// Lets the arm of `scene`, which must be critically damped, start at rest and
// move freely for `seconds` >= 0 before the touch: sets touch_speed_m_s and
// lead_m, in closed form.
void SetApproach(double seconds, ContactScene& scene);

// Where the arm is `before_s` >= 0 before the touch if its approach takes
// `approach_s`: metres from the place of the touch, 0 or below.
double ApproachPosition(double approach_s, double before_s,
                        const ContactScene& scene);

// b_act of a critically damped arm (paper, eq. 10 with eta = 1), N s/m.
double CriticalDamping(double actuator_stiffness, double arm_mass_kg);

// OK if every field is in range; else INVALID_SCENE naming the field.
absl::Status Validate(const ContactScene& scene);

}  // namespace tactus::internal
