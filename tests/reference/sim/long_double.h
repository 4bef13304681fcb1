// File: long_double.h
//
// A second, slow integration of the contact model, to compare the exact one
// (core/sim/exact/exact.h) with. It computes in long double, steps every phase
// with its matrix exponential at a small fraction of the ringing's period, and
// searches every step for events. It shares only the scene with the exact
// method.
//
//   TACTUS_ASSIGN_OR_RETURN(Trajectory run, IntegrateReference(scene, 2000));
//
// Takes up to seconds a contact. Same scene, same bits. Stateless;
// thread-safe. Source: paper, eqs. 1 to 7.
#pragma once

#include "absl/status/statusor.h"
#include "core/sim/model/scene.h"
#include "core/sim/model/trajectory.h"

namespace tactus::internal {

// INVALID_SCENE for a bad scene, NUMERICAL_FAILURE if it would need more than
// 10^9 steps.
// `step_share` is the length of a step relative to the time scale of the
// fastest motion. A loss of contact that begins and ends within one step is
// missed.
absl::StatusOr<Trajectory> IntegrateReference(const ContactScene& scene,
                                              double sample_rate_hz,
                                              double step_share = 0.7);

}  // namespace tactus::internal
