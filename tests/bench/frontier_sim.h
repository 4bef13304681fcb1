// File: frontier_sim.h
//
// Time and error of the simulator, and a classifier's accuracy on its contacts:
// the exact method at several skip tolerances, and CVODE, on the same scenes.
//
//   TACTUS_ASSIGN_OR_RETURN(auto points, MeasureSimulators(served, quick));
//
// Thread-safe: a function without state.
#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "core/classify/compiled_model.h"
#include "tests/bench/frontier.h"

namespace tactus::client {

// Simulates scenes of the grid. An error is the largest of a noiseless feature,
// relative to the feature's peak, against tests/reference/sim/long_double.h. An
// accuracy is that of `model` on the method's contacts with noise. Returns
// NUMERICAL_FAILURE if an error of the exact method exceeds its stated bound.
absl::StatusOr<std::vector<FrontierPoint>> MeasureSimulators(
    const std::shared_ptr<const CompiledModel>& model, bool quick);

}  // namespace tactus::client
