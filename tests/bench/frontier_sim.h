// File: frontier_sim.h
//
// What digits of the simulator cost, and whether a classifier minds: the exact
// method at several tolerances of what it leaps over, and CVODE, on the same
// scenes.
//
//   TACTUS_ASSIGN_OR_RETURN(auto points, MeasureSimulators(served, quick));
//
// Thread-safe.
#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "core/classify/compiled_model.h"
#include "tests/bench/frontier_point.h"

namespace tactus::client {

// Scenes of the grid. Errors are of the noiseless features, shares of a
// feature's peak, against the reference of core/sim/model/reference.h;
// accuracies are of `model` on the method's contacts with noise.
// NUMERICAL_FAILURE if the exact method is off by more than it states.
absl::StatusOr<std::vector<FrontierPoint>> MeasureSimulators(
    const std::shared_ptr<const CompiledModel>& model, bool quick);

}  // namespace tactus::client
