// File: magnet_touches.h
//
// What simulated contacts change of the field at the magnetometers of an
// AnySkin skin.
//
//   SimTouches touches({.contacts = 40});
//   AnySkinBoard board({}, MagnetSource(touches, /*newton_per_ut=*/0.001));
//
// The forearm of SimTouches is shrunk to the skin, rows upwards, and the force
// of each of its taxels changes the fields around it: along z, and further off
// also away from it. Light forces add up; as the elastomer stiffens, no field
// changes by more than 3000 uT. This is no model of a real elastomer: such a
// skin feels where, how hard and how long it is touched, in numbers of the size
// of real ones. Thread-safe: a free function.
#pragma once

#include "tools/fakeskin/anyskin_board.h"
#include "tools/fakeskin/sim_touches.h"

namespace tactus::internal::client {

// `touches` outlives the source. A light force of `newton_per_ut` changes the
// field by 1 uT at its place.
AnySkinBoard::Source MagnetSource(SimTouches& touches, double newton_per_ut);

}  // namespace tactus::internal::client
