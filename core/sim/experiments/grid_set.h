// File: grid_set.h
//
// Robot conditions that no model was trained at: a grid over arm stiffness,
// speed and goal, and a draw of contacts spread evenly over it.
//
//   const auto specs =
//       DrawSpecs(GridConditions({250, 4000}, {0.04}, {0.01, 0.02}), seed);
//   // The first 4 n specs hold n contacts of each of the 4 conditions.
//   Trial trial = contact.Metadata();
//   trial.condition = ConditionName(contact.spec.robot);
//
// Stateless; thread-safe. Same arguments, same bits.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/sim/model/materials.h"
#include "core/sim/model/trial_spec.h"

namespace tactus {

// From half the paper's stiffnesses and speeds to twice, spaced evenly by
// ratio; no value is one of the paper's.
struct Grid {
  std::vector<double> stiffnesses = {250, 630, 1600, 4000};        // N/m
  std::vector<double> velocities = {0.0025, 0.0063, 0.016, 0.04};  // m/s
  std::vector<double> goals = {0.01, 0.02, 0.04};                  // m
};

// Every combination, goals varying fastest.
std::vector<RobotCondition> GridConditions(
    const std::vector<double>& stiffnesses,
    const std::vector<double>& velocities, const std::vector<double>& goals);

// Cubes of `materials` (TrialSpecs) under `robots`, in an order that is even
// from the start: round after round, one object of each condition, drawn
// without return. Numbers are those of TrialSpecs.
std::vector<TrialSpec> DrawSpecs(
    const std::vector<RobotCondition>& robots, uint64_t seed,
    std::span<const Material> materials = Materials());

// "k630-v0.016-g0.02": names all that makes the condition.
std::string ConditionName(const RobotCondition& robot);

}  // namespace tactus
