// File: exact.h
//
// The exact integration of a ContactScene: each phase (phases.h) is solved in
// closed form and left at the event that ends it, so that there are no time
// steps and no error to control. Ringing in contact costs nothing; bounces are
// followed one by one.
//
//   TACTUS_ASSIGN_OR_RETURN(Trajectory run, IntegrateExact(scene, {}));
//
// Same scene, same bits; the motion does not depend on the sampling rate.
// Stateless; thread-safe. Source: paper, eqs. 1 to 7.
#pragma once

#include <cstdint>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/sim/contact_piece.h"
#include "core/sim/scene.h"
#include "core/sim/trajectory.h"

namespace tactus {

struct ExactOptions {
  // Of the trajectory; a multiple of 100 Hz.
  double sample_rate_hz = 2000;
  // False if nobody needs to know when the arm touches (the area signal and
  // a trajectory do): bounces too small to be felt are then skipped, see
  // SkippedBounceSpeed().
  bool contact_time = true;
  // What skipping may change in the force signal, as a share of the friction
  // of the sliding object; 0 to 0.1.
  double skip_tolerance = 1e-3;
  // A contact that needs more is an error, not a stall.
  int64_t max_events = 20'000'000;
};

// Bounces are skipped, and the object slides on with the arm, once it meets
// the arm more slowly than this, m/s. While it bounces at up to w, its
// momentum differs from that of smooth sliding by at most m_obj w. The mean
// force over an interval of the filter's input (signals.h) therefore differs
// by (e[n] - e[n-1]) rate with |e| <= m_obj w, and the filtered force, summed
// by parts, by at most V m_obj w rate, where V is the sum of |h[n] - h[n-1]|
// over the filter's impulse response. The speed is such that this is the
// tolerated share of m_obj mu_k g, with w at twice the speed: from bounce to
// bounce speed cubed over acceleration towards the arm stays the same, so it
// takes eight times the acceleration to double it.
double SkippedBounceSpeed(const ContactScene& scene,
                          const ExactOptions& options);

// OK if every field is in range; else INVALID_SCENE naming the field.
absl::Status Validate(const ExactOptions& options);

struct PieceSummary {
  EventCounts events;
  bool moved = false;
};

// Takes a contact as it is solved, in order and without gaps from 0 to the
// scene's end.
class PieceSink {
 public:
  virtual ~PieceSink() = default;
  // The next piece and its duration, s.
  virtual void Take(const ContactPiece& piece, double duration) = 0;
  // Time of the next sample: pieces that end before it may come as totals.
  virtual double NextSample() const = 0;
  // The impulse (N s) and the time in contact (s) of such pieces.
  virtual void TakeTotals(double impulse, double contact_time) = 0;
};

// Solves the contact piece by piece. INVALID_SCENE for a bad scene or option,
// NUMERICAL_FAILURE if there are too many events.
absl::StatusOr<PieceSummary> SolvePieces(const ContactScene& scene,
                                         const ExactOptions& options,
                                         PieceSink& sink);

// The same, sampled. Errors as above.
absl::StatusOr<Trajectory> IntegrateExact(const ContactScene& scene,
                                          const ExactOptions& options);

}  // namespace tactus
