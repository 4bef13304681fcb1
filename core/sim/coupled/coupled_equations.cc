#include "core/sim/coupled/coupled_equations.h"

#include <algorithm>
#include <cmath>

namespace tactus::internal {

CoupledMatrix CoupledEquations(const CoupledScene& scene,
                               const CoupledPhases& phases, double speed) {
  const ContactScene& arm = scene.arm;
  CoupledMatrix a = CoupledMatrix::Zero();
  a(kCoupledArm, kCoupledArmSpeed) = 1;
  a(kCoupledEquilibrium, kCoupledOne) = speed;
  const double spring = arm.actuator_stiffness / arm.arm_mass_kg;
  const double damper = arm.actuator_damping / arm.arm_mass_kg;
  a(kCoupledArmSpeed, kCoupledArm) = -spring;
  a(kCoupledArmSpeed, kCoupledEquilibrium) = spring;
  a(kCoupledArmSpeed, kCoupledArmSpeed) = -damper;
  a(kCoupledArmSpeed, kCoupledOne) = damper * speed;
  for (int i = 0; i < static_cast<int>(scene.objects.size()); ++i) {
    const CoupledObject& object = scene.objects[i];
    a(DeformationOf(i), kCoupledArmSpeed) = 1;
    a(DeformationOf(i), SpeedOf(i)) = -1;
    if (Sliding(phases[i])) {
      a(SpeedOf(i), kCoupledOne) = -object.mu_kinetic * kGravity;
    }
    if (!Touching(phases[i])) continue;
    a(kCoupledArmSpeed, DeformationOf(i)) = -object.stiffness / arm.arm_mass_kg;
    a(IntegralOf(i), DeformationOf(i)) = 1;
    if (Sliding(phases[i])) {
      a(SpeedOf(i), DeformationOf(i)) = object.stiffness / object.mass_kg;
    }
  }
  return a;
}

double FastestRate(const CoupledScene& scene, const CoupledPhases& phases) {
  const ContactScene& arm = scene.arm;
  double springs = arm.actuator_stiffness;
  double ringing = 0;
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    if (!Touching(phases[i])) continue;
    const CoupledObject& object = scene.objects[i];
    springs += object.stiffness;
    if (Sliding(phases[i])) {
      ringing = std::max(ringing, object.stiffness / object.mass_kg);
    }
  }
  return std::sqrt(springs / arm.arm_mass_kg + ringing) +
         arm.actuator_damping / arm.arm_mass_kg;
}

}  // namespace tactus::internal
