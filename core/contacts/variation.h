// File: variation.h
//
// Copies of a contact as other arms and objects would have made it. Models that
// are trained on them hold at speeds, stiffnesses and materials that were never
// recorded. Apart from its ringing, the lumped element model (paper, eqs. 1 to
// 7) has three symmetries:
//
// - Pace. Force, area and motion depend on how far the equilibrium point has
//   come. An arm of another speed plays the same signals at another pace.
// - Load. The pieces of the model are linear. A softer arm on a lighter object
//   makes all forces and motions smaller by one factor. The sensor's noise does
//   not shrink, so the noise that the factor removed is drawn again.
// - Stiffness. If all springs and masses, including the object's, are larger by
//   one factor, forces are larger by that factor and motions do not change. The
//   ringing keeps this symmetry too.
//
// Changing pace or load never changes the class. Changing stiffness is
// allowed only if the object stays on its side of the hard/soft border.
//
//   Random random(seed);
//   LabelledContact other = Vary(contact, {.pace = 1.4, .load = 0.5}, random);
//
// Thread-safe: free functions.
#pragma once

#include <vector>

#include "core/base/random.h"
#include "core/contacts/labelled_contact.h"

namespace tactus::internal {

struct Variation {
  double pace = 1;       // > 0
  double load = 1;       // in (0, 1]: noise cannot be taken away
  double stiffness = 1;  // > 0
};

// Standard deviations of the noise on a contact's numbers (NoiseOf).
struct ContactNoise {
  double force = 0;
  double net_force = 0;
  double motion = 0;
};
ContactNoise NoiseIn(const LabelledContact& contact);

// Frame k of the copy is `contact` at (k + 1) x pace frames after the touch,
// interpolated between two frames; before the first frame it is the first. The
// copy ends where `contact` ends and has at most as many frames. The load
// profile, and frames with a loss of touch on either side, are not interpolated
// but taken from the earlier frame.
LabelledContact Vary(const LabelledContact& contact, const Variation& variation,
                     Random& random);
// The same into `varied`, whose memory is used again. `noise` is that of
// `contact`.
void Vary(const LabelledContact& contact, const ContactNoise& noise,
          const Variation& variation, Random& random, LabelledContact& varied);

// Estimates the standard deviation of the noise on values[t] from the median of
// their second differences. A signal with a constant slope has none. Returns 0
// for fewer than 3 values. (The median of |normal| is 0.6745; a second
// difference of noise has 6 times its variance.)
double NoiseOf(const std::vector<double>& values);

}  // namespace tactus::internal
