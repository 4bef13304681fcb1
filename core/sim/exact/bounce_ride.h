// File: bounce_ride.h
//
// Follows a train of bounces, up to 10^9 in one contact, in leaps: it solves
// one bounce in `stride` (bounce.h) and extrapolates the others by a polynomial
// through the solved ones (bounce_series.h). The polynomial's error at the next
// solved bounce is the error estimate and sets the stride. At a sample, it
// solves the bounce that is under way.
//
//   time = RideBounces(ride, time, sink, next, summary);
//
// Bounces that are too small for the skin are replaced by their mean, see
// SkippedBounceBound(). Stateless; thread-safe.
#pragma once

#include <cstdint>

#include "core/sim/exact/contact_modes.h"
#include "core/sim/exact/contact_piece.h"
#include "core/sim/exact/piece_sink.h"
#include "core/sim/model/equilibrium.h"
#include "core/sim/model/scene.h"

namespace tactus::internal {

// A bound on the change of the filtered force (relative to the friction) and of
// the filtered area (relative to the face) if each sample takes the mean of the
// bounces. Each bounce takes `flight` and `contact` seconds; arm and object
// move against each other at up to `speed` (m/s).
//
// The input of the skin's filter (signals.h) is a mean over an interval. Its
// change is e[n] - e[n-1], where e is the change of the impulse, or of the time
// in contact, since the start. For the impulse, |e| <= m_obj speed, the
// momentum against the arm. For the time in contact, |e| <= flight contact /
// (flight + contact), as within one bounce. Summation by parts bounds the
// filtered change by V max |e| rate, where V is the sum of |h[n] - h[n-1]| over
// the filter's impulse response. Objects that bounce are so hard that strain
// does not change the area.
double SkippedBounceBound(const ContactScene& scene, double speed,
                          double flight, double contact);

struct BounceRide {
  const ContactScene* scene;
  const ContactModes* modes;
  // The equilibrium point is on this leg until `until`, s.
  const EquilibriumLeg* leg;
  double until = 0;
  // Limits the error estimate of a leap, and SkippedBounceBound() of bounces
  // that are replaced by their mean. At 0 every bounce is solved.
  double skip_tolerance = 0;
  int64_t max_solved = 0;
};

// Follows a train of bounces that starts at `time` with `next` as long as they
// are simple (bounce.h). Returns the time at which that ends; `next` is then
// the start of the next phase.
double RideBounces(const BounceRide& ride, double time, PieceSink& sink,
                   PhaseStart& next, PieceSummary& summary);

}  // namespace tactus::internal
