#include "tests/reference/sim/phase_equations.h"

#include <limits>

namespace tactus::internal {

PhaseEquations::PhaseEquations(const ContactScene& scene, ContactPhase p,
                               const EquilibriumLeg& leg)
    : stiffness(Touching(p) ? scene.object_stiffness : 0),
      static_limit(scene.fixed ? std::numeric_limits<double>::infinity()
                               : scene.StaticLimit()),
      arm_stiffness(scene.actuator_stiffness / scene.arm_mass_kg),
      arm_damping(scene.actuator_damping / scene.arm_mass_kg),
      arm_compliance(1 / scene.arm_mass_kg),
      object_compliance(Sliding(p) ? 1 / scene.object_mass_kg : 0),
      friction(Sliding(p) ? scene.mu_kinetic * kGravity : 0),
      equilibrium(leg.origin_m),
      speed(leg.speed_m_s),
      phase(p) {}

void PhaseEquations::Derivative(double time, const double* state,
                                double* derivative) const {
  const double force = stiffness * state[kDeformation];
  const double x_arm = state[kObjectPosition] + state[kDeformation];
  derivative[kDeformation] = state[kArmVelocity] - state[kObjectVelocity];
  derivative[kArmVelocity] =
      arm_stiffness * (equilibrium + speed * time - x_arm) +
      arm_damping * (speed - state[kArmVelocity]) - arm_compliance * force;
  derivative[kObjectPosition] = state[kObjectVelocity];
  derivative[kObjectVelocity] = object_compliance * force - friction;
}

void PhaseEquations::Jacobian(double* const* columns) const {
  for (int column = 0; column < kSceneStates; ++column) {
    for (int row = 0; row < kSceneStates; ++row) columns[column][row] = 0;
  }
  columns[kDeformation][kArmVelocity] =
      -arm_stiffness - arm_compliance * stiffness;
  columns[kDeformation][kObjectVelocity] = object_compliance * stiffness;
  columns[kArmVelocity][kDeformation] = 1;
  columns[kArmVelocity][kArmVelocity] = -arm_damping;
  columns[kObjectPosition][kArmVelocity] = -arm_stiffness;
  columns[kObjectVelocity][kDeformation] = -1;
  columns[kObjectVelocity][kObjectPosition] = 1;
}

void PhaseEquations::Events(const double* state, double* values) const {
  values[0] = state[kDeformation];
  if (Sliding(phase)) {
    values[1] = state[kObjectVelocity];
  } else if (Touching(phase) &&
             static_limit < std::numeric_limits<double>::infinity()) {
    values[1] = stiffness * state[kDeformation] - static_limit;
  } else {
    values[1] = 1;
  }
}

double PhaseEquations::Impulse(double span, const double* from,
                               const double* to) const {
  if (!Touching(phase)) return 0;
  if (object_compliance > arm_compliance) {
    // A light object rings faster than the ends can tell: use its momentum.
    return (to[kObjectVelocity] - from[kObjectVelocity] + friction * span) /
           object_compliance;
  }
  // Cubic interpolation of the deformation; its rate is known at both ends.
  const double rate_change = from[kArmVelocity] - from[kObjectVelocity] -
                             to[kArmVelocity] + to[kObjectVelocity];
  return stiffness * span *
         ((from[kDeformation] + to[kDeformation]) / 2 +
          span * rate_change / 12);
}

}  // namespace tactus::internal
