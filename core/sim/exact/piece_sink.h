// File: piece_sink.h
//
// What takes an exact contact (exact.h) as it is solved: in order and without
// gaps from 0 to the scene's end.
//
//   TACTUS_RETURN_IF_ERROR(SolvePieces(scene, {}, sampler).status());
//
// Not thread-safe: one a contact.
#pragma once

#include <cstdint>

#include "core/sim/exact/contact_piece.h"
#include "core/sim/model/trajectory.h"

namespace tactus {

// How a sink sees a train of bounces.
enum class BounceDetail {
  kMean,     // samples; bounces too small to be felt at their mean
  kInstant,  // samples, each at its instant
  kPieces,   // every flight and contact
};

class PieceSink {
 public:
  virtual ~PieceSink() = default;
  virtual BounceDetail detail() const = 0;
  // The next piece and its duration, s.
  virtual void Take(const ContactPiece& piece, double duration) = 0;
  // Bounces come as samples and totals instead, unless pieces are asked for:
  // the time of the next sample, the state there, and the impulse (N s) and
  // the time in contact (s) since what was taken last.
  virtual double NextSample() const = 0;
  virtual void TakeSample(const PieceState& state, double impulse,
                          double contact_time) = 0;
  virtual void TakeTotals(double impulse, double contact_time) = 0;
};

// Where a phase starts.
struct PhaseStart {
  ContactPhase phase = ContactPhase::kStuck;
  PieceState state;
};

struct PieceSummary {
  EventCounts events;
  // Bounces that were solved, and that were leapt over.
  int64_t solved = 0;
  int64_t skipped = 0;
  bool moved = false;
};

}  // namespace tactus
