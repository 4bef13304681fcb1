// File: random_world.h
//
// A world of random contacts, to train and test models on more than a
// laboratory could record. Everything is drawn independently, so that nothing
// about an object but its physics is correlated with its class.
//
//   for (uint64_t n = 0; n < 100'000; ++n) {
//     TACTUS_ASSIGN_OR_RETURN(Trial trial, WorldTrial(skin, seed, n));
//   }
//
// | drawn | how |
// |---|---|
// | Young's modulus | 2e3 to 6e10 Pa, log-uniform |
// | density | 30 to 8,000 kg/m^3, log-uniform |
// | static friction | 0.12 to 0.95, uniform; sliding 0.6 to 0.95 of it |
// | Poisson's ratio | 0.2 to 0.49, uniform |
// | edge of the cube | 1 to 20 cm, uniform |
// | fixed | half of the objects |
// | arm | stiffness, speed and goal log-uniform, 1/4 to 4 times the paper's |
// | approach | free for up to 1 s before the touch, in half of them |
// | place, tilt | DrawPlacement |
// | poses | noise 0.05 to 2 mm, log-uniform; gain error up to 2 % |
// | poses, skin `paper` | noise 1 um, no gain error |
//
// Contact n is a function of seed and n: a caller holds one at a time, and
// workers share nothing. Two seeds have no contact, material or arm in common.
// Stateless; thread-safe.
#pragma once

#include <cstdint>

#include "absl/status/statusor.h"
#include "core/base/random.h"
#include "core/data/trial.h"
#include "core/sim/model/trial_spec.h"
#include "core/sim/skin/record_contact.h"
#include "core/sim/skin/skin_model.h"

namespace tactus::internal {

// An object that moved less than this by the end of a contact is labelled
// unmoved: an impact may shift an object by a micrometre, which nobody would
// call moved.
inline constexpr double kWorldMovedM = 0.001;

struct WorldContact {
  TrialSpec spec;
  Placement placement;
};

// Draws contact `number`; leaves `random`, which it sets, ready for the skin.
WorldContact DrawWorldContact(const SkinModel& skin, uint64_t seed,
                              uint64_t number, Random& random);

// Simulates and records contact `number`. Its condition is the octave of the
// arm's stiffness and speed, e.g. "k512-v2^-7", its material the decade of
// Young's modulus and the octave of the density: groups that can be left out.
// NUMERICAL_FAILURE as SimulateContact.
absl::StatusOr<Trial> WorldTrial(const SkinModel& skin, uint64_t seed,
                                 uint64_t number);

// The same contact as ideal signals with `noise`.
absl::StatusOr<Trial> WorldSignals(const SignalNoise& noise, uint64_t seed,
                                   uint64_t number);

}  // namespace tactus::internal
