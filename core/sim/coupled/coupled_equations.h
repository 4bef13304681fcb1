// File: coupled_equations.h
//
// The motion of a CoupledScene between two events: a linear differential
// equation with constant coefficients, x' = A x, where x holds a constant 1 and
// the equilibrium point as well.
//
//   const CoupledMatrix a = CoupledEquations(scene, phases, leg.speed_m_s);
//   const CoupledState rate = a * state;
//
// Functions without state; thread-safe. SI units. Source: paper, eqs. 1 to 7,
// with the sum of all contact forces on the arm.
#pragma once

#include <array>

#include "Eigen/Core"
#include "core/base/limits.h"
#include "core/sim/coupled/coupled_scene.h"
#include "core/sim/model/contact_phase.h"

namespace tactus::internal {

// Places in the state. Each object has its deformation (m; below 0 when
// apart), its speed (m/s), and the integral of the deformation while touching
// (m s). The deformation is a state of its own because a stiff contact would
// lose it in the difference of two positions.
inline constexpr int kCoupledArm = 0;
inline constexpr int kCoupledArmSpeed = 1;
inline constexpr int kCoupledOne = 2;
inline constexpr int kCoupledEquilibrium = 3;
inline constexpr int DeformationOf(int object) { return 4 + 3 * object; }
inline constexpr int SpeedOf(int object) { return 5 + 3 * object; }
inline constexpr int IntegralOf(int object) { return 6 + 3 * object; }
inline constexpr int kCoupledStates = 4 + 3 * limits::kMaxSceneObjects;

using CoupledState = Eigen::Matrix<double, kCoupledStates, 1>;
using CoupledMatrix = Eigen::Matrix<double, kCoupledStates, kCoupledStates>;
using CoupledPhases = std::array<ContactPhase, limits::kMaxSceneObjects>;

// A, while the equilibrium point moves at `speed` (m/s).
CoupledMatrix CoupledEquations(const CoupledScene& scene,
                               const CoupledPhases& phases, double speed);

// No root of A is larger, 1/s.
double FastestRate(const CoupledScene& scene, const CoupledPhases& phases);

}  // namespace tactus::internal
