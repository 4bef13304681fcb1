// File: equilibrium.h
//
// The way of the arm's equilibrium point in a ContactScene: forward to the
// goal, rest, and back if the scene has a retreat. Its speed is constant on
// each leg.
//
//   for (const EquilibriumLeg& leg : EquilibriumLegs(scene)) {
//     const double position = leg.PositionAt(leg.end_s);
//   }
//
// Plain data and a function without state; thread-safe. SI units.
#pragma once

#include <vector>

#include "core/sim/model/scene.h"

namespace tactus::internal {

struct EquilibriumLeg {
  // Where the point would have been at the touch at this speed, m.
  double origin_m = 0;
  // Below 0 on the way back.
  double speed_m_s = 0;
  // The leg ends this long after the touch, s; the last one never ends.
  double end_s = 0;

  double PositionAt(double time_s) const {
    return origin_m + speed_m_s * time_s;
  }
};

// The legs of a valid scene in the order of time. A retreat that begins before
// the goal is reached leaves out the rest.
std::vector<EquilibriumLeg> EquilibriumLegs(const ContactScene& scene);

}  // namespace tactus::internal
