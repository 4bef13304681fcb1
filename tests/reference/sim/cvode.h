// File: cvode.h
//
// Integrates a ContactScene with SUNDIALS CVODE: BDF of order up to 5 with a
// dense Newton solver, as the paper used MATLAB's ode15s (Section
// "Implementation"). Each phase (contact_phase.h) is integrated up to the event
// that root finding locates; there the solver restarts. The ends of
// the equilibrium point's legs (equilibrium.h) are known times; each ends a
// step exactly.
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
#include "core/sim/model/trial_spec.h"
#include "core/sim/skin/simulated_contact.h"

namespace tactus::internal {

struct SolverOptions {
  double relative_tolerance = 1e-4;
  // Absolute tolerances, in the unit each quantity is read in.
  double force_tolerance = 1e-5;     // N, of the contact force
  double velocity_tolerance = 1e-7;  // m/s
  double position_tolerance = 1e-9;  // m, of the object
  // Highest order, 1 to 5, in contacts that ring faster than a 100 Hz skin can
  // resolve. BDF above order 2 is not stable on the imaginary axis: order 2
  // damps the ringing; order 5 resolves it, in small steps to the end.
  int ringing_order = 2;
  // Rate of the trajectory; a multiple of 100 Hz.
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

// SimulateContact (core/sim/exact/simulate_contact.h) by CVODE. Without `area`,
// that signal stays 0. Errors as above.
absl::StatusOr<SimulatedContact> SimulateByCvode(const TrialSpec& spec,
                                                 const SolverOptions& options,
                                                 bool area = true);

}  // namespace tactus::internal
