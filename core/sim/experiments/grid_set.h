// File: grid_set.h
//
// Robot conditions at which no model was trained: a grid over arm stiffness,
// speed and goal, and contacts drawn evenly over it.
//
//   const auto specs = DrawSpecs(UntrainedGrid().Conditions(), seed);
//   // The first 48 n specs hold n contacts of each of the 48 conditions.
//   Trial trial = contact.Metadata();
//   trial.condition = ConditionName(contact.spec.robot);
//
// Stateless; thread-safe. Same arguments, same bits.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/sim/experiments/paper_set.h"
#include "core/sim/model/materials.h"
#include "core/sim/model/trial_spec.h"

namespace tactus::internal {

// From half the paper's stiffnesses and speeds to twice, spaced evenly by
// ratio: {250, 630, 1600, 4000} N/m x {0.0025, 0.0063, 0.016, 0.04} m/s x
// {0.01, 0.02, 0.04} m. No value is one of the paper's.
RobotGrid UntrainedGrid();

// The specs of TrialSpecs in another order: in each round one object of every
// condition, drawn without replacement. So any first part of the list is spread
// evenly over the conditions. The numbers are those of TrialSpecs.
std::vector<TrialSpec> DrawSpecs(
    const std::vector<RobotCondition>& robots, uint64_t seed,
    std::span<const Material> materials = Materials());

// "k630-v0.016-g0.02": stiffness, velocity and goal.
std::string ConditionName(const RobotCondition& robot);

}  // namespace tactus::internal
