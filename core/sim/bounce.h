// File: bounce.h
//
// The quick way through a train of bounces: a light hard object that slides
// rings faster than the arm moves and may leave it and come back hundreds of
// thousands of times. Flights and contacts so short that the slow motion is a
// few terms of its Taylor series need neither exponentials nor a search for
// their end; Newton's method finds it next to that of the bounce before.
//
//   BounceTrain train(scene, modes, ramping, time, phase, state);
//   double impulse;
//   while (train.Next(until, &impulse) > 0) total += impulse;
//
// The same equations as contact_piece.h, to double precision: a bounce that is
// not certainly of this simple kind is left to the general way. Keeps pointers
// to `scene` and `modes`. Not thread-safe.
#pragma once

#include "core/sim/contact_modes.h"
#include "core/sim/contact_piece.h"
#include "core/sim/phases.h"
#include "core/sim/scene.h"

namespace tactus {

class BounceTrain {
 public:
  // `phase` is kSliding or kCoasting and `state` its start, touching.
  BounceTrain(const ContactScene& scene, const ContactModes& modes,
              bool ramping, double time, ContactPhase phase,
              const PieceState& state);

  // Moves to the next change of contact and returns its distance in seconds
  // and the contact's impulse (N s) on the way. 0, and nothing moved, if the
  // next piece is not certainly an undisturbed flight or contact that ends
  // before `until`.
  double Next(double until, double* impulse);

  double time() const { return now_.time; }
  ContactPhase phase() const { return PhaseOf(now_); }
  PieceState state() const { return StateOf(now_); }

  // Where the piece that Next() passed began.
  double last_time() const { return last_.time; }
  ContactPhase last_phase() const { return PhaseOf(last_); }
  PieceState last_state() const { return StateOf(last_); }

 private:
  // The moment of a change of contact: the arm in the frame of its
  // equilibrium point, and its approach to the object.
  struct Moment {
    double time = 0;
    double lag = 0;
    double rate = 0;
    double approach = 0;
    bool touching = false;
  };

  static ContactPhase PhaseOf(const Moment& moment) {
    return moment.touching ? ContactPhase::kSliding : ContactPhase::kCoasting;
  }
  PieceState StateOf(const Moment& moment) const;
  // Each moves `moment` to the end of a flight or contact and returns its
  // span; 0 or less if it is not certainly a simple one.
  double Fly(Moment& moment) const;
  double Press(Moment& moment, double* impulse);
  // Turns the remembered angle of the ringing.
  void Turn(double angle);

  const ContactScene* scene_;
  const ContactModes* modes_;
  Moment now_;
  Moment last_;
  double equilibrium_speed_;
  double equilibrium_start_;
  // Constants of the scene, folded.
  double friction_;    // acceleration, m/s^2
  double compliance_;  // m_obj / k_obj
  double rigidity_;    // its inverse
  double offset_;      // of the object's rest from the arm's
  double fast_[2][2];  // fast pair from what the slow operator leaves
  double softness_;    // of the fast pair, 1 / stiffness
  double frequency_;
  double period_;  // 1 / frequency
  double decay_;
  double slowest_span_;  // longest piece the Taylor series may span, s
  // Of the last contact: angle of the ringing at its end, cosine and sine,
  // and by how much it differed from the one before.
  double angle_ = 0;
  double drift_ = 0;
  double cosine_ = 1;
  double sine_ = 0;
};

}  // namespace tactus
