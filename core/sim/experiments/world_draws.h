// File: world_draws.h
//
// The random choices of a world of contacts (random_world.h lists the ranges):
// an object, an arm and the errors of its poses, each drawn independently.
//
//   TrialSpec spec;
//   DrawWorldObject(random, spec);
//   DrawWorldArm(random, spec);
//
// Stateless; thread-safe with one generator for each thread.
#pragma once

#include <string>

#include "core/base/random.h"
#include "core/sim/model/trial_spec.h"
#include "core/sim/skin/record_contact.h"
#include "core/sim/skin/skin_model.h"

namespace tactus::internal {

// `low` to `high`, both above 0.
double LogUniformBetween(double low, double high, Random& random);

// Sets the object and whether it is fixed.
void DrawWorldObject(Random& random, TrialSpec& spec);

// Sets the robot and the time of its free approach.
void DrawWorldArm(Random& random, TrialSpec& spec);

// Sets the noise and the gain error of the poses.
void DrawPoseErrors(const SkinModel& skin, Random& random,
                    Placement& placement);

// The octave of the arm's stiffness and speed, "k512-v2^-7".
std::string WorldCondition(const RobotCondition& robot);

}  // namespace tactus::internal
