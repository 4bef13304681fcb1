// File: read_signals.h
//
// The signals of an ideal skin, computed sample by sample from a trajectory:
// the reference for core/sim/exact/piece_signals.h, which computes them in
// closed form.
//
//   TACTUS_ASSIGN_OR_RETURN(Trajectory run, IntegrateCvode(scene, {}));
//   IdealSignals signals = ReadSignals(cube, run);
//
// Use a trajectory of 2 kHz to compare with piece_signals.h, which filters at
// that rate.
//
// Thread-safe: a function without state. The result owns its arrays.
#pragma once

#include "core/sim/model/materials.h"
#include "core/sim/model/trajectory.h"
#include "core/sim/skin/signals.h"

namespace tactus::internal {

// Force and area enter the filter as means over each interval of the
// trajectory. Both are 0 while arm and object are apart, so short impacts count
// with their impulse. The trajectory's rate must be a multiple of 100 Hz above
// 400 Hz. Without `area`, that signal stays 0.
IdealSignals ReadSignals(const Cube& cube, const Trajectory& trajectory,
                         bool area = true);

}  // namespace tactus::internal
