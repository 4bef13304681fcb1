// File: variation.h
//
// A contact as other arms and objects would have made it, so that models hold
// at speeds, stiffnesses and materials that were never recorded. But for its
// ringing the lumped element model (paper, eqs. 1 to 7) has three symmetries:
//
// - Pace. Force, area and motion follow how far the equilibrium point has come;
//   an arm of another speed plays the same signals at another pace.
// - Load. The pieces are linear: a softer arm on a lighter object makes all
//   forces and motions smaller by one factor. The sensor's noise stays, so what
//   was scaled away of it is drawn anew.
// - Stiffness. With all springs and masses, the object's among them, larger by
//   one factor, forces are too, and motions stay; ringing as well.
//
// Pace and load leave every category alone, stiffness those on whose side of
// the border between hard and soft it stays.
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

// Frame k, (k + 1) frames after the touch, is `contact` (k + 1) x pace frames
// after it, between frames interpolated, at first the first; as long as the
// contact lasts and no longer than its frames are many. Where touch is lost on
// either side, and for the load profile, the frame before counts.
LabelledContact Vary(const LabelledContact& contact, const Variation& variation,
                     Random& random);

// How many copies to draw of each contact, from what: the logarithm of the pace
// evenly between 1 / pace and pace, that of the load between 1 / load and 1. In
// every other copy also that of the stiffness, between 1 / stiffness and
// stiffness: objects of classes that others are all stiffer than stay as soft
// as the stiffest known of their class, those that are stiffer than all of
// another as hard as its softest. Others, and all where a stiffness is unknown,
// keep theirs.
struct VariationRange {
  int copies = 0;
  double pace = 1;       // >= 1
  double load = 1;       // >= 1
  double stiffness = 1;  // >= 1
};

// All copies of all contacts; the same contacts, range and seed give the same
// copies.
std::vector<LabelledContact> DrawVariations(
    const std::vector<const LabelledContact*>& contacts,
    const VariationRange& range, uint64_t seed);

// Standard deviation of the noise on values[t], from the median of their second
// differences: a signal that changes evenly, however fast, has none. 0 for
// fewer than 3 values. (The median of |normal| is 0.6745; a second difference
// of noise has 6 times its variance.)
double NoiseOf(const std::vector<double>& values);

}  // namespace tactus
