// File: cody_set.h
//
// The paper's experiment with the robot Cody (Section "Experiments with a Real
// Robot") in simulation. The forearm pushes eight objects under two joint
// stiffnesses and two joint velocities, four times each; seven of the objects
// both free and held: 7 x 2 x 2 x 2 x 4 + 1 x 2 x 2 x 4 = 240 trials. Each
// trial holds the first 1.2 s after onset.
//
//   for (const CodySpec& spec : CodySpecs(layout, seed)) {
//     TACTUS_ASSIGN_OR_RETURN(auto contact, SimulateContact(spec.contact));
//     TACTUS_ASSIGN_OR_RETURN(
//         Trial trial, CodySkinTrial(spec, contact, skin, seed));
//   }
//
// From the paper: the counts, 2.01 and 20.1 Nm/rad, 5 and 20 deg/s, hard
// objects of 8,000 to 100,000 N/m and above, soft ones of 630 to 1,500 N/m, a
// heavy iron bucket that is never moved. The paper does not state the rest, so
// we chose it: the objects, their masses and friction, the lever arm, the goal,
// and the differences between repetitions (research/virtual-cody.md). The faces
// of all objects are drawn from one distribution, so that size alone names no
// material.
//
// Stateless; thread-safe. Same arguments, same bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/data/trial.h"
#include "core/sim/model/trial_spec.h"
#include "core/sim/skin/signals.h"
#include "core/sim/skin/simulated_contact.h"
#include "core/sim/skin/skin_model.h"
#include "core/skin/geometry.h"
#include "core/skin/layout.h"

namespace tactus::internal {

inline constexpr double kCodyWindowS = 1.2;
inline constexpr int kCodyRepetitions = 4;
// An object that moved less than this by the end of the window is labelled
// unmoved: an observer would not notice so small a motion.
inline constexpr double kCodyMovedM = 0.001;

struct CodyObject {
  const char* name;
  bool hard;
  // False for the object that is only tried held.
  bool movable;
  double stiffness;  // N/m, whole object
  double mass_kg;
  Friction table;
};

// All eight; the four soft ones first.
std::span<const CodyObject> CodyObjects();

struct CodySpec {
  CodyObject object;
  double joint_stiffness = 0;  // Nm/rad
  double joint_velocity = 0;   // deg/s
  // The resulting contact of arm and object; `fixed` if held.
  TrialSpec contact;
  // Middle of the contact on the skin.
  SkinPoint centre;
};

// Metres from the shoulder's axis to row `row` of the skin, the arm stretched.
double CodyLeverArm(const SkinLayout& layout, double row);

// All 240, in the order of conditions, objects, free before held, repetitions.
// `layout` is the forearm's.
std::vector<CodySpec> CodySpecs(const SkinLayout& layout, uint64_t seed);

// The window's trial, with signals or as a skin records it. Its label is H or S
// by the object, and M or U by the object's motion at the end of the window.
// Condition, object and material name what the paper varies, so that
// leave-one-material-out leaves out one object. If the skin does not feel the
// contact, the window is 1.2 s from the touch on.
absl::StatusOr<Trial> CodySignalTrial(const CodySpec& spec,
                                      const SimulatedContact& contact,
                                      const SignalNoise& noise, uint64_t seed);
absl::StatusOr<Trial> CodySkinTrial(const CodySpec& spec,
                                    const SimulatedContact& contact,
                                    const SkinModel& skin, uint64_t seed);

}  // namespace tactus::internal
