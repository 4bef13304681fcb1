// File: coupled.h
//
// Integrates a CoupledScene: between two events the motion is linear
// (coupled_equations.h), so a step is one product with a matrix exponential.
// Within a step the motion is its power series, on which events are located.
//
//   TACTUS_ASSIGN_OR_RETURN(std::vector<Trajectory> runs,
//                           IntegrateCoupled(scene, {}));
//   const TrajectorySample& end = runs[1].samples.back();  // of object 1
//
// A step is 0.7 radian of the fastest ringing, so the work grows with it:
// unlike IntegrateExact (core/sim/exact/exact.h), it solves every turn and
// bounce.
// Within a step, a motion that turns more than once may hide an event. Contacts
// do not damp. Same scene, same bits. Stateless; thread-safe. Source: paper,
// eqs. 1 to 7.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "core/sim/coupled/coupled_scene.h"
#include "core/sim/model/trajectory.h"

namespace tactus::internal {

struct CoupledOptions {
  // Rate of the trajectories; a multiple of 100 Hz, 500 to
  // limits::kMaxTrajectoryRateHz.
  double sample_rate_hz = 2000;
  // A scene that needs more of either is an error.
  int64_t max_steps = 100'000'000;
  int64_t max_events = 1'000'000;
};

// One for each object, in their order: the arm's motion is the same in all. The
// object's position counts from where it lay. INVALID_SCENE for a bad scene or
// option, NUMERICAL_FAILURE if there are too many steps or events.
absl::StatusOr<std::vector<Trajectory>> IntegrateCoupled(
    const CoupledScene& scene, const CoupledOptions& options);

}  // namespace tactus::internal
