// File: cvode.h
//
// The reference integration of a ContactScene: SUNDIALS CVODE, BDF of order
// up to 5 with a dense Newton solver, as the paper used MATLAB's ode15s
// (Section "Implementation"). Each phase (phases.h) is integrated up to the
// event that root finding locates, where the solver starts afresh; the end
// of the equilibrium point's ramp is a known time and ends a step exactly.
//
//   TACTUS_ASSIGN_OR_RETURN(Trajectory run, IntegrateCvode(scene, {}));
//
// Same scene, same bits. Thread-safe: each call owns its solver.
#pragma once

#include <cstdint>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/sim/model/scene.h"
#include "core/sim/model/trajectory.h"

namespace tactus {

struct SolverOptions {
  double relative_tolerance = 1e-4;
  // Absolute tolerances, in the unit each quantity is read in.
  double force_tolerance = 1e-5;     // N, of the contact force
  double velocity_tolerance = 1e-7;  // m/s
  double position_tolerance = 1e-9;  // m, of the object
  // Highest order, 1 to 5, in contacts that ring faster than a 100 Hz skin can
  // tell. BDF above order 2 is not stable on the imaginary axis: order 2 lets
  // the ringing fade, 5 resolves it, in small steps to the end.
  int ringing_order = 2;
  // Of the trajectory; whole samples at 100 Hz, so a multiple of that.
  double sample_rate_hz = 2000;
  // A run that needs more is an error, not a stall.
  int max_events = 200'000;
  int64_t max_steps = 20'000'000;
};

// OK if every field is in range; else INVALID_SCENE naming the field.
absl::Status Validate(const SolverOptions& options);

// INVALID_SCENE for a bad scene or option, NUMERICAL_FAILURE if the solver
// gives up.
absl::StatusOr<Trajectory> IntegrateCvode(const ContactScene& scene,
                                          const SolverOptions& options);

}  // namespace tactus
