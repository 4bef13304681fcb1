// File: phase_equations.h
//
// The differential equation of one contact phase
// (core/sim/model/contact_phase.h) and the functions whose zeros end it, in the
// form that a step-by-step solver takes.
//
//   PhaseEquations equations(scene, ContactPhase::kStuck, leg);
//   equations.Derivative(time, state, derivative);
//
// Plain data; thread-safe once built.
#pragma once

#include <array>

#include "core/sim/model/contact_phase.h"
#include "core/sim/model/equilibrium.h"
#include "core/sim/model/scene.h"

namespace tactus::internal {

// State: deformation x_arm - x_uobj (m; below 0 when apart), v_arm, x_uobj,
// v_uobj. The deformation is a separate state because a stiff
// contact would lose it in the difference of two positions.
inline constexpr int kDeformation = 0;
inline constexpr int kArmVelocity = 1;
inline constexpr int kObjectPosition = 2;
inline constexpr int kObjectVelocity = 3;
inline constexpr int kSceneStates = 4;

using SceneState = std::array<double, kSceneStates>;

// The equations of one phase: scene constants, folded.
struct PhaseEquations {
  PhaseEquations(const ContactScene& scene, ContactPhase phase,
                 const EquilibriumLeg& leg);

  // Writes d(state)/dt at `time` (s).
  void Derivative(double time, const double* state, double* derivative) const;
  // Writes the constant Jacobian, column-major, kSceneStates squared.
  void Jacobian(double* const* columns) const;
  // Two functions whose zero crossings end the phase: contact (deformation
  // 0) and the object's slip or stop.
  void Events(const double* state, double* values) const;

  // Integral of the contact force over `span` seconds of this phase, N s, from
  // the states at both ends.
  double Impulse(double span, const double* from, const double* to) const;

  double stiffness;          // contact, N/m; 0 when apart
  double static_limit;       // N, infinite if fixed
  double arm_stiffness;      // k_act / m_arm
  double arm_damping;        // b_act / m_arm
  double arm_compliance;     // 1 / m_arm
  double object_compliance;  // 1 / m_obj; 0 at rest
  double friction;           // friction / m_obj; 0 at rest
  double equilibrium;        // x_eq = equilibrium + speed * time
  double speed;
  ContactPhase phase;
};

}  // namespace tactus::internal
