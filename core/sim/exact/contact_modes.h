// File: contact_modes.h
//
// The natural modes of a ContactScene in each phase: the arm alone, the arm on
// the object's spring while the object is stuck, and, while it slides, the
// two pairs of the fourth-order system of arm, spring and object: a slow one
// (arm and object move together) and a fast one (the contact rings).
//
//   ContactModes modes(scene);
//   modes.fast.fastest();  // rad/s of the ringing while sliding
//
// Immutable once built; thread-safe. Source: paper, eqs. 1 to 6; their
// characteristic polynomial is (m s^2 + b s + k + K)(M s^2 + K) - K^2.
#pragma once

#include "core/sim/exact/damped_pair.h"
#include "core/sim/model/scene.h"

namespace tactus::internal {

struct ContactModes {
  // `scene` is valid.
  explicit ContactModes(const ContactScene& scene);

  // Contact stiffness used, N/m. If the slow and the fast pair coincide, as
  // with equal masses on equal springs, it is changed by about 1e-11 of its
  // value, so that the pairs differ.
  double stiffness;
  DampedPair arm;
  DampedPair stuck;
  // While sliding; `arm` twice if the object is fixed.
  DampedPair slow;
  DampedPair fast;
};

}  // namespace tactus::internal
