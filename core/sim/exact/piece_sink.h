// File: piece_sink.h
//
// PieceSink: receives an exact contact (exact.h) while it is solved, in order
// and without gaps from 0 to the end of the scene.
//
//   TACTUS_RETURN_IF_ERROR(SolvePieces(scene, {}, sampler).status());
//
// Not thread-safe: one sink per contact.
#pragma once

#include <cstdint>

#include "core/sim/exact/contact_piece.h"
#include "core/sim/model/trajectory.h"

namespace tactus::internal {

// How a sink receives a train of bounces.
enum class BounceDetail {
  kMean,     // samples; bounces too small for the skin by their mean
  kInstant,  // samples, each at its exact time
  kPieces,   // every flight and contact
};

class PieceSink {
 public:
  virtual ~PieceSink() = default;
  virtual BounceDetail detail() const = 0;
  // The next piece and its duration, s.
  virtual void Take(const ContactPiece& piece, double duration) = 0;
  // Unless detail() is kPieces, bounces arrive as samples and totals instead:
  // the time of the next sample, the state at that time, and the impulse (N s)
  // and the time in contact (s) since the last call.
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
  // Number of bounces that were solved, and that were skipped.
  int64_t solved = 0;
  int64_t skipped = 0;
  bool moved = false;
};

}  // namespace tactus::internal
