// File: bounce.h
//
// Solves a train of bounces fast. A light hard object that slides rings faster
// than the arm moves; it may leave the arm and return hundreds of thousands of
// times. If flights and contacts are so short that a few terms of a Taylor
// series describe the slow motion, they need no exponentials and no search for
// their end: Newton's method starts at the end of the bounce before.
//
//   BounceTrain train(scene, modes, leg);
//   BounceMoment moment = train.MomentOf(phase, time, state);
//   while (train.Next(until, moment) > 0) ++changes_of_contact;
//
// The equations are those of contact_piece.h, to double precision. A bounce
// that is not certainly simple is left to the general method. Keeps a pointer
// to `modes`. Not thread-safe.
#pragma once

#include "core/sim/exact/contact_modes.h"
#include "core/sim/exact/contact_piece.h"
#include "core/sim/model/contact_phase.h"
#include "core/sim/model/equilibrium.h"
#include "core/sim/model/scene.h"

namespace tactus::internal {

// An instant at which contact is made or lost: the arm's motion relative to its
// equilibrium point, and its approach to the object.
struct BounceMoment {
  double time = 0;
  double lag = 0;
  double rate = 0;
  double approach = 0;
  // True if they touch from now on.
  bool touching = false;
};

class BounceTrain {
 public:
  BounceTrain(const ContactScene& scene, const ContactModes& modes,
              const EquilibriumLeg& leg);

  // `phase` is kSliding or kCoasting and `state` its start, touching.
  BounceMoment MomentOf(ContactPhase phase, double time,
                        const PieceState& state) const;
  PieceState StateOf(const BounceMoment& moment) const;
  static ContactPhase PhaseOf(const BounceMoment& moment) {
    return moment.touching ? ContactPhase::kSliding : ContactPhase::kCoasting;
  }

  // Moves `moment` to the next change of contact and returns its distance in
  // seconds. 0, and nothing moved, if the next piece is not certainly an
  // undisturbed flight or contact that ends before `until`.
  double Next(double until, BounceMoment& moment);

 private:
  // Each moves `moment` to the end of a flight or contact and returns its
  // span; 0 or less if it is not certainly a simple one.
  double Fly(BounceMoment& moment) const;
  double Press(BounceMoment& moment);
  // The same with kTerms terms of the slow motion's series. `span` is a first
  // guess of the flight's duration.
  template <int kTerms>
  double FlyBy(BounceMoment& moment, double span) const;
  template <int kTerms>
  double PressBy(BounceMoment& moment);
  // Turns the remembered angle of the ringing.
  void Turn(double angle);

  const ContactModes* modes_;
  EquilibriumLeg leg_;
  // Constants derived from the scene.
  double friction_;    // acceleration, m/s^2
  double compliance_;  // m_obj / k_obj
  double rigidity_;    // its inverse
  double offset_;      // of the object's rest from the arm's
  double fast_[2][2];  // fast pair from what the slow operator leaves
  double softness_;    // of the fast pair, 1 / stiffness
  double frequency_;
  double period_;  // 1 / frequency
  double decay_;
  // Longest pieces, s, for the short and for the long series.
  double short_span_;
  double long_span_;
  // Angle of the ringing at the end of the last contact, its difference from
  // the contact before, and its cosine and sine.
  double angle_ = 0;
  double drift_ = 0;
  double cosine_ = 1;
  double sine_ = 0;
};

}  // namespace tactus::internal
