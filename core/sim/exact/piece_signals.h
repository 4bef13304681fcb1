// File: piece_signals.h
//
// The ideal skin's signals (signals.h) straight from the pieces of an exact
// contact, without a trajectory in between: within a piece, force and motion
// are polynomials plus damped pairs. Mean, filter and decimation are linear, so
// their effect on each form is known in advance. The result equals that of a
// trajectory sampled at 2 kHz (tests/reference/sim/read_signals.h) up to
// rounding.
//
//   PieceSignals reader(cube, scene, /*area=*/true);
//   TACTUS_RETURN_IF_ERROR(SolvePieces(scene, {}, reader).status());
//   IdealSignals signals = reader.Finish();
//
// Not thread-safe: one reader per contact.
#pragma once

#include <array>

#include "core/sim/exact/contact_piece.h"
#include "core/sim/exact/piece_sink.h"
#include "core/sim/model/scene.h"
#include "core/sim/skin/block_filter.h"
#include "core/sim/skin/signals.h"

namespace tactus::internal {

class PieceSignals : public PieceSink {
 public:
  // Without `area`, that signal stays 0.
  PieceSignals(const Cube& cube, const ContactScene& scene, bool area);

  BounceDetail detail() const override { return BounceDetail::kMean; }
  void Take(const ContactPiece& piece, double duration) override;
  double NextSample() const override {
    return closed_ < intervals_ ? Boundary(closed_ + 1) : kNever;
  }
  void TakeSample(const PieceState& state, double impulse,
                  double contact_time) override;
  void TakeTotals(double impulse, double contact_time) override {
    impulse_ += impulse;
    contact_ += contact_time;
  }
  IdealSignals Finish() { return std::move(signals_); }

 private:
  static constexpr double kNever = 1e300;  // s

  // Contribution of force and motion to the filter in a frame, by the pair's
  // state before the frame: [from].
  struct PairColumns {
    std::array<BlockFilter::Column, 2> force = {};
    std::array<BlockFilter::Column, 2> motion = {};
  };
  // Effect of the pairs of one phase on a frame.
  struct PairTable {
    // State after a frame, by its state before: [of][from].
    std::array<std::array<double, 2>, 2> frame;
    // Force of each interval, by the state before: [from].
    std::array<BlockFilter::Inputs, 2> force;
    PairColumns drive;
    // The filter's states once earlier inputs have decayed.
    PairColumns steady;
  };
  struct PhaseTable {
    bool ready = false;
    // False if a pair decays too fast for a steady state.
    bool steady = true;
    std::array<PairTable, 2> pairs;
  };

  // The pairs of a piece at the start of a frame, and the mean force in its
  // first interval without them.
  struct FrameStart {
    std::array<const DampedPair*, 2> pairs;
    std::array<PairState, 2> states;
    int used = 0;
    double force = 0;
  };

  double Boundary(int interval) const { return interval / kSignalRateHz; }
  void FillTable(const ContactPiece& piece, PhaseTable& table);
  // Processes the whole frames that remain in the piece.
  void TakeFrames(const ContactPiece& piece, double end);
  // True if `form` is constant from here on, up to rounding.
  static bool Settled(const PieceForm& form, const FrameStart& start);
  void FillSteady(const DampedPair& pair, PairTable& table, bool& steady) const;
  // Adds a frame that is in contact throughout to the area's filter. `pairs`:
  // the pairs' contribution to the force's filter, or its state once steady.
  void TakeArea(const PieceForm& force, const FrameStart& start,
                const PhaseTable& table, const BlockFilter::Column& pairs,
                bool steady);
  // Closes the current interval with its impulse (N s), the time in contact (s)
  // and the positions of arm and object at its end.
  void CloseInterval(double impulse, double contact, double arm, double object);
  // Stores the filters' outputs as a sample.
  void CloseFrame(double object);
  double Area(double share, double force);
  // Areas under `forces`, in contact throughout.
  BlockFilter::Inputs Areas(const BlockFilter::Inputs& forces);

  const BlockFilter& filter_;
  Cube cube_;
  bool with_area_;
  double full_area_;
  double strain_per_newton_;
  int intervals_;  // in the whole contact
  int closed_ = 0;
  // Sums of the current interval, up to now.
  double impulse_ = 0;
  double contact_ = 0;
  bool clamped_ = false;
  BlockFilter::Inputs force_ = {};
  BlockFilter::Inputs area_ = {};
  BlockFilter::Inputs motion_ = {};
  BlockFilter::Column force_state_ = {};
  BlockFilter::Column area_state_ = {};
  BlockFilter::Column motion_state_ = {};
  std::array<PhaseTable, 4> tables_;
  IdealSignals signals_;
};

}  // namespace tactus::internal
