// File: contact_piece.h
//
// One piece of a contact in closed form: the motion from a known state on,
// within one phase (contact_phase.h) and on one leg of the equilibrium point's
// way (equilibrium.h). It consists of polynomials and damped pairs; there are
// no time steps.
//
//   ContactPiece piece(scene, modes, ContactPhase::kStuck, leg,
//                      /*begin=*/0, {});
//   PieceState later = piece.At(0.01);
//
// Keeps pointers to `scene` and `modes`, which must outlive it. Immutable;
// thread-safe. SI units. Source: paper, eqs. 1 to 7.
#pragma once

#include <array>

#include "core/sim/exact/contact_modes.h"
#include "core/sim/exact/first_crossing.h"
#include "core/sim/model/contact_phase.h"
#include "core/sim/model/equilibrium.h"
#include "core/sim/model/scene.h"

namespace tactus::internal {

// Holds the deformation and its rate instead of the arm's position and
// velocity: the small deformation of a stiff contact would be lost in the
// difference of two positions.
struct PieceState {
  double deformation = 0;  // x_arm - x_uobj, m; below 0 when apart
  double approach = 0;     // its rate, m/s
  double position = 0;     // x_uobj, m
  double speed = 0;        // of the object, m/s

  double arm_position() const { return position + deformation; }
  double arm_speed() const { return speed + approach; }
};

// A quantity of a piece, `t` seconds into it:
// constant + slope t + sum over its pairs of value[i] y_i + rate[i] y_i'.
struct PieceForm {
  double constant = 0;
  double slope = 0;
  std::array<double, 2> value = {0, 0};
  std::array<double, 2> rate = {0, 0};
};

class ContactPiece {
 public:
  ContactPiece(const ContactScene& scene, const ContactModes& modes,
               ContactPhase phase, const EquilibriumLeg& leg, double begin,
               const PieceState& start);

  ContactPhase phase() const { return phase_; }
  double begin() const { return begin_; }
  const PieceState& start() const { return start_; }
  // N/m; 0 when apart.
  double stiffness() const { return Touching(phase_) ? modes_->stiffness : 0; }

  // The state `t` >= 0 seconds into the piece.
  PieceState At(double t) const;
  // The state at its start, without the fast part if the object slides.
  PieceState WithoutRinging() const;
  // Integral of the contact force over its first `t` seconds, N s.
  double Impulse(double t) const;

  // Functions of the time since the start of the piece.
  ModalFunction Deformation() const;
  ModalFunction ObjectSpeed() const;

  // The damped pairs of the piece (null if unused), their states at its start,
  // and contact force, x_arm and x_uobj in terms of them. x_uobj has no such
  // form while the object coasts.
  std::array<const DampedPair*, 2> pairs() const;
  std::array<PairState, 2> states() const { return {main_, ringing_}; }
  PieceForm Force() const;
  PieceForm ArmPosition() const;
  PieceForm ObjectPosition() const;

 private:
  // `state` of the pair that is the second derivative of this one.
  static PairState Curvature(const DampedPair& pair, const PairState& state) {
    return pair.Derivative(pair.Derivative(state));
  }

  const ContactScene* scene_;
  const ContactModes* modes_;
  ContactPhase phase_;
  double begin_;
  PieceState start_;
  double equilibrium_speed_;
  double drift_ = 0;  // speed of the particular solution of the deformation
  double compliance_ = 0;  // m_obj / k_obj while sliding
  // Stuck: the deformation. Sliding: the slow part of x_uobj. Apart: x_arm. In
  // each case without the particular solution.
  const DampedPair* pair_;
  PairState main_;
  // Sliding: the fast part of x_uobj.
  PairState ringing_;
};

}  // namespace tactus::internal
