// File: paper_set.h
//
// The paper's simulated experiment as a list of trials that can run one by one,
// in any order: 13 materials x 10 edge lengths x {wood, glass} under each robot
// condition, and for each trial whose object moved a twin with the object
// fixed.
//
//   auto specs = TrialSpecs(PaperConditions());
//   TACTUS_RETURN_IF_ERROR(ForEachContact(
//       specs, {}, [&](const SimulatedContact& contact) {
//         trials.push_back(SignalTrial(contact, {}, seed));
//         return absl::OkStatus();
//       }));
//
// Stateless; thread-safe. Trials are independent: callers may run
// SimulateContact for all specs in parallel, then for the twins of the trials
// whose object moved.
#pragma once

#include <span>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "core/sim/exact/simulate_contact.h"
#include "core/sim/model/materials.h"
#include "core/sim/model/trial_spec.h"

namespace tactus {

// The paper's four conditions: {543, 2050} N/m x {0.005, 0.02} m/s.
std::vector<RobotCondition> PaperConditions(double goal_m = kPaperGoal);

// Twenty specs per condition and material, none fixed. With the paper's
// materials these are 260 per condition.
std::vector<TrialSpec> TrialSpecs(
    const std::vector<RobotCondition>& robots,
    std::span<const Material> materials = Materials());

// Simulates `specs` in order and passes each contact to `take`. If its object
// moved, its twin follows directly. Stops at the first error.
absl::Status ForEachContact(
    std::span<const TrialSpec> specs, const SimulateOptions& options,
    absl::FunctionRef<absl::Status(const SimulatedContact&)> take);

}  // namespace tactus
