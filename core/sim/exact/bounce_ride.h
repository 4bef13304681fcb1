// File: bounce_ride.h
//
// Rides through a train of bounces, up to 10^9 in one contact, in leaps: one
// bounce in `stride` is solved (bounce.h), the others follow from a polynomial
// through these (bounce_series.h). What the polynomial misses of the next
// bounce is the error's estimate and sets the stride. Where a sink takes a
// sample, the one bounce under way is solved.
//
//   time = RideBounces(ride, time, sink, next, summary);
//
// Bounces too small to be felt are passed at their mean instead, see
// SkippedBounceBound(). Stateless; thread-safe.
#pragma once

#include <cstdint>

#include "core/sim/exact/contact_modes.h"
#include "core/sim/exact/contact_piece.h"
#include "core/sim/exact/piece_sink.h"
#include "core/sim/model/scene.h"

namespace tactus {

// What the filtered force, as a share of the friction, and the filtered area,
// as a share of the face, may change by at most if bounces take so long in
// flight and contact (s), move arm and object against each other at up to
// `speed` (m/s), and each sample takes their mean.
//
// The skin's filter (signals.h) sees means over intervals of its input, that
// is differences e[n] - e[n-1] of what impulse and time in contact have summed
// up to. Of the impulse, |e| <= m_obj speed, the momentum against the arm; of
// the time in contact, |e| <= flight contact / (flight + contact), as within
// one bounce. Summed by parts, the filtered difference is at most
// V max |e| rate, where V is the sum of |h[n] - h[n-1]| over the filter's
// impulse response. Objects that bounce are so hard that strain leaves the
// area alone.
double SkippedBounceBound(const ContactScene& scene, double speed,
                          double flight, double contact);

struct BounceRide {
  const ContactScene* scene;
  const ContactModes* modes;
  // The equilibrium point keeps its speed until then.
  bool ramping = true;
  double until = 0;
  // Limits what a leap may miss, and SkippedBounceBound() of bounces that are
  // passed at their mean. At 0 every bounce is solved.
  double skip_tolerance = 0;
  int64_t max_solved = 0;
};

// Follows a train of bounces that starts at `time` with `next` for as long as
// they are simple, and returns when that ends; `next` is then the start of
// what follows.
double RideBounces(const BounceRide& ride, double time, PieceSink& sink,
                   PhaseStart& next, PieceSummary& summary);

}  // namespace tactus
