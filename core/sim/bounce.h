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
//   while (auto span = train.Next(&impulse)) ...
//
// The same equations as contact_piece.h, to double precision: a bounce that is
// not certainly of this simple kind is left to the general way. Keeps pointers
// to `scene` and `modes`. Not thread-safe.
#pragma once

#include <optional>

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
              const ContactState& state);

  // Moves to the next change of contact and returns its distance in seconds
  // and the contact's impulse (N s) on the way. Null, and nothing moved, if
  // the next piece is not certainly an undisturbed flight or contact that
  // ends before `until`.
  std::optional<double> Next(double until, double* impulse);

  double time() const { return time_; }
  ContactPhase phase() const {
    return touching_ ? ContactPhase::kSliding : ContactPhase::kCoasting;
  }
  ContactState state() const;

 private:
  // Of the arm, in its equilibrium point's frame, and its approach to the
  // object, both at the surface.
  struct Surface {
    double lag = 0;
    double rate = 0;
    double approach = 0;
  };

  std::optional<double> Fly(Surface& at) const;
  std::optional<double> Press(Surface& at, double* impulse);
  void Turn(double angle);

  const ContactScene* scene_;
  const ContactModes* modes_;
  bool touching_;
  double time_;
  Surface at_;
  double equilibrium_speed_;
  double equilibrium_start_;
  // Constants of the scene, folded.
  double friction_;     // acceleration, m/s^2
  double compliance_;   // m_obj / k_obj
  double offset_;       // of the object's rest from the arm's
  double fast_[2][2];   // fast pair from what the slow operator leaves
  double frequency_;
  double decay_;
  double slowest_span_;  // longest piece the Taylor series may span, s
  // Of the last contact: angle of the ringing at its end, cosine and sine.
  double angle_ = 0;
  double cosine_ = 1;
  double sine_ = 0;
};

}  // namespace tactus
