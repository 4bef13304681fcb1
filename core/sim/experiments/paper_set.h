// File: paper_set.h
//
// The paper's simulated experiment as a list of trials that can be run one by
// one, in any order: 13 materials x 10 edge lengths x {wood, glass} under
// each robot condition, and a twin with the object fixed for each that moved.
//
//   auto specs = TrialSpecs(PaperConditions());
//   TACTUS_RETURN_IF_ERROR(ForEachContact(
//       specs, {}, [&](const SimulatedContact& contact) {
//         trials.push_back(SignalTrial(contact, {}, seed));
//         return absl::OkStatus();
//       }));
//
// Stateless; thread-safe. Trials are independent: callers may run
// SimulateContact for specs in parallel, then for the twins of those that
// moved.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/data/trial.h"
#include "core/sim/exact/exact.h"
#include "core/sim/model/cvode.h"
#include "core/sim/model/materials.h"
#include "core/sim/model/scene.h"
#include "core/sim/skin/signals.h"

namespace tactus {

inline constexpr double kPaperGoal = 0.019;          // m
inline constexpr double kHardStiffness = 100'000.0;  // N/m; hard from here up

struct RobotCondition {
  double stiffness = 543;   // N/m
  double velocity = 0.005;  // m/s
  double goal_m = kPaperGoal;
};

struct TrialSpec {
  Cube object;
  RobotCondition robot;
  bool fixed = false;
  // Tells trials of one list apart and draws their noise: even, and one more
  // for the fixed twin.
  uint64_t number = 0;
};

// The paper's four conditions: {543, 2050} N/m x {0.005, 0.02} m/s.
std::vector<RobotCondition> PaperConditions(double goal_m = kPaperGoal);

// Twenty specs for each condition and material, none fixed: 260 a condition
// with the paper's.
std::vector<TrialSpec> TrialSpecs(
    const std::vector<RobotCondition>& robots,
    std::span<const Material> materials = Materials());

ContactScene SceneOf(const TrialSpec& spec);

struct SimulatedContact {
  TrialSpec spec;
  IdealSignals signals;
  bool moved = false;
  EventCounts events;
  // Not solved one by one (bounce_ride.h).
  int64_t skipped_bounces = 0;
  int64_t steps = 0;  // of the solver; 0 if the method takes none

  bool hard() const { return spec.object.Stiffness() >= kHardStiffness; }
  // "HU", "HM", "SU" or "SM".
  std::string Label() const;
  // Number, label, condition, object and so on, without signals or taxels.
  Trial Metadata() const;
};

// The same trial with the object fixed.
TrialSpec FixedTwin(const TrialSpec& spec);

enum class SimMethod { kExact, kCvode };

struct SimulateOptions {
  SimMethod method = SimMethod::kExact;
  // Without it, the area signal stays 0.
  bool area = true;
  ExactOptions exact;
  SolverOptions cvode;
};

// INVALID_SCENE for a bad spec, NUMERICAL_FAILURE if the method gives up.
absl::StatusOr<SimulatedContact> SimulateContact(
    const TrialSpec& spec, const SimulateOptions& options = {});

// Runs `specs` in order, the twin of one that moved directly after it, and
// hands each to `take`. Stops at the first error.
absl::Status ForEachContact(
    std::span<const TrialSpec> specs, const SimulateOptions& options,
    absl::FunctionRef<absl::Status(const SimulatedContact&)> take);

// The trial with its three signals and their noise, drawn from `seed` and the
// trial's number.
Trial SignalTrial(const SimulatedContact& contact, const SignalNoise& noise,
                  uint64_t seed);

}  // namespace tactus
