// File: press_together.h
//
// Simulates several objects that one arm presses at once, each from a TrialSpec
// and its distance ahead of the arm to what an ideal skin reads of it. All
// contacts count their time from the same instant, at which the arm is at
// distance 0.
//
//   const PressedObject objects[] = {{.spec = first},
//                                    {.spec = second, .distance_m = 0.004}};
//   TACTUS_ASSIGN_OR_RETURN(std::vector<SimulatedContact> contacts,
//                           PressTogether(objects));
//
// The area signal stays 0. The arm, its lift-off and the duration are those of
// the first spec. Same arguments, same bits. Stateless; thread-safe.
#pragma once

#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/sim/model/trial_spec.h"
#include "core/sim/skin/simulated_contact.h"

namespace tactus::internal {

// A contact that would ring faster, rad/s, is softened until it does not: its
// steps would be too many (coupled.h). A force F then presses arm and object,
// of masses M and m, by F (1/M + 1/m) / 1e8 into each other: at most 0.2 um
// where friction holds an object lighter than the arm, else 2 um per 100 N.
inline constexpr double kMaxRingingRadS = 1e4;

struct PressedObject {
  TrialSpec spec;
  // From the arm to the object at time 0, m.
  double distance_m = 0;
};

// One for each object. INVALID_SCENE for a bad spec or distance,
// NUMERICAL_FAILURE as IntegrateCoupled.
absl::StatusOr<std::vector<SimulatedContact>> PressTogether(
    std::span<const PressedObject> objects);

// Where the arm is after `seconds`, in whole milliseconds and at least 10, m.
// Errors as above.
absl::StatusOr<double> ArmAfter(double seconds,
                                std::span<const PressedObject> objects);

}  // namespace tactus::internal
