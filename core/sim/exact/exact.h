// File: exact.h
//
// The exact integration of a ContactScene: each phase (contact_phase.h) is
// solved in closed form up to the event that ends it. There are no time steps
// and no step error. Ringing in contact costs no extra time. Trains of bounces
// are extrapolated (bounce_ride.h).
//
//   TACTUS_ASSIGN_OR_RETURN(Trajectory run, IntegrateExact(scene, {}));
//
// Same scene, same bits; the motion does not depend on the sampling rate.
// Stateless; thread-safe. Source: paper, eqs. 1 to 7.
#pragma once

#include <cstdint>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/sim/exact/piece_sink.h"
#include "core/sim/model/scene.h"
#include "core/sim/model/trajectory.h"

namespace tactus::internal {

struct ExactOptions {
  // Rate of the trajectory; a multiple of 100 Hz.
  double sample_rate_hz = 2000;
  // Largest change of the signals by skipped bounces, relative to the friction
  // of the sliding object and to the area of its face (bounce_ride.h); 0 to
  // 0.1. At 0 every bounce is solved.
  double skip_tolerance = 1e-3;
  // Largest number of solved bounces. A contact with more is an error.
  int64_t max_events = 5'000'000;
};

// OK if every field is in range; else INVALID_SCENE naming the field.
absl::Status Validate(const ExactOptions& options);

// Solves the contact piece by piece. INVALID_SCENE for a bad scene or option,
// NUMERICAL_FAILURE if there are too many events.
absl::StatusOr<PieceSummary> SolvePieces(const ContactScene& scene,
                                         const ExactOptions& options,
                                         PieceSink& sink);

// The same, sampled. Errors as above.
absl::StatusOr<Trajectory> IntegrateExact(const ContactScene& scene,
                                          const ExactOptions& options);

}  // namespace tactus::internal
