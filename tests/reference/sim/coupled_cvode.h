// File: coupled_cvode.h
//
// Integrates a CoupledScene with SUNDIALS CVODE: BDF with a dense Newton solver
// and root finding at a relative tolerance of 1e-11. It shares only the scene
// with core/sim/coupled/coupled.h: the forces are written down once more, in
// positions.
//
//   TACTUS_ASSIGN_OR_RETURN(std::vector<Trajectory> runs,
//                           IntegrateCoupledCvode(scene, 2000));
//
// For contacts that ring slower than about 5000 rad/s. Impulse and time in
// contact stay 0. Same scene, same bits. Thread-safe: each call owns its
// solver.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/sim/coupled/coupled_scene.h"
#include "core/sim/model/trajectory.h"

namespace tactus::internal {

// One for each object. INVALID_SCENE for a bad scene, NUMERICAL_FAILURE if the
// solver gives up.
absl::StatusOr<std::vector<Trajectory>> IntegrateCoupledCvode(
    const CoupledScene& scene, double sample_rate_hz);

}  // namespace tactus::internal
