// File: paper_set.h
//
// The paper's simulated experiment as a list of trials that can run one by one,
// in any order: 13 materials x 10 edge lengths x {wood, glass} under each robot
// condition, and for each trial whose object moved a twin with the object
// fixed.
//
//   for (const TrialSpec& spec : TrialSpecs(PaperGrid().Conditions())) {
//     TACTUS_ASSIGN_OR_RETURN(const auto contacts, SimulateWithTwin(spec));
//     for (const SimulatedContact& contact : contacts) {
//       trials.push_back(SignalTrial(contact, {}, seed));
//     }
//   }
//
// Stateless; thread-safe. Trials are independent: callers may simulate the
// specs in parallel.
#pragma once

#include <span>
#include <vector>

#include "core/sim/model/materials.h"
#include "core/sim/model/trial_spec.h"

namespace tactus::internal {

// Robot conditions: every combination of these values.
struct RobotGrid {
  std::vector<double> stiffnesses = {};  // N/m
  std::vector<double> velocities = {};   // m/s
  std::vector<double> goals = {};        // m

  // Goals vary fastest, stiffnesses slowest.
  std::vector<RobotCondition> Conditions() const;
};

// The paper's four conditions: {543, 2050} N/m x {0.005, 0.02} m/s.
RobotGrid PaperGrid();

// Twenty specs per condition and material, none fixed. With the paper's
// materials these are 260 per condition.
std::vector<TrialSpec> TrialSpecs(
    const std::vector<RobotCondition>& robots,
    std::span<const Material> materials = Materials());

}  // namespace tactus::internal
