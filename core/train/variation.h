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
// Changing pace or load never changes the category. Changing stiffness is
// allowed only if the object stays on its side of the hard/soft border.
//
//   Random random(seed);
//   LabelledContact other = Vary(contact, {.pace = 1.4, .load = 0.5}, random);
//
// Thread-safe: free functions.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/random.h"
#include "core/train/labelled_contact.h"

namespace tactus {

struct Variation {
  double pace = 1;       // > 0
  double load = 1;       // in (0, 1]: noise cannot be taken away
  double stiffness = 1;  // > 0
};

// Frame k of the copy is `contact` at (k + 1) x pace frames after the touch,
// interpolated between two frames; before the first frame it is the first. The
// copy ends where `contact` ends and has at most as many frames. The load
// profile, and frames with a loss of touch on either side, are not interpolated
// but taken from the earlier frame.
LabelledContact Vary(const LabelledContact& contact, const Variation& variation,
                     Random& random);

// How many copies of each contact are drawn, and from which ranges. The factors
// are uniform in their logarithm: pace from 1 / pace to pace, load from
// 1 / load to 1, and in every second copy stiffness from 1 / stiffness to
// stiffness. A class is soft if all objects of another class are stiffer; its
// copies get no stiffer than its stiffest object. A class is hard if all
// objects of another class are softer; its copies get no softer than its
// softest object. Other classes keep their stiffness, and so do all if the
// stiffness of any contact is unknown.
struct VariationRange {
  int copies = 0;
  double pace = 1;       // >= 1
  double load = 1;       // >= 1
  double stiffness = 1;  // >= 1
};

// Returns all copies of all contacts. The same contacts, range and seed give
// the same copies.
std::vector<LabelledContact> DrawVariations(
    const std::vector<const LabelledContact*>& contacts,
    const VariationRange& range, uint64_t seed);

// Estimates the standard deviation of the noise on values[t] from the median of
// their second differences. A signal with a constant slope has none. Returns 0
// for fewer than 3 values. (The median of |normal| is 0.6745; a second
// difference of noise has 6 times its variance.)
double NoiseOf(const std::vector<double>& values);

}  // namespace tactus
