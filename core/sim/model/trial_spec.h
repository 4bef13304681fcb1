// File: trial_spec.h
//
// TrialSpec: one simulated trial before it runs, i.e. a cube, how the robot
// pushes it, and whether the cube is fixed.
//
//   TrialSpec spec;
//   spec.object = {Materials()[0], 0.05, Surface::kWood};
//   spec.robot = {.stiffness = 543, .velocity = 0.005};
//   ContactScene scene = SceneOf(spec);
//
// Plain data and functions without state; thread-safe.
#pragma once

#include <cstdint>
#include <limits>

#include "core/sim/model/materials.h"
#include "core/sim/model/scene.h"

namespace tactus::internal {

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
  // Time for which the arm moves freely before the touch, s; 0: it starts at
  // rest on the object.
  double approach_s = 0;
  double duration_s = 5;
  // The lift-off, as in ContactScene.
  double retreat_after_s = std::numeric_limits<double>::infinity();
  double retreat_speed_m_s = 0;
  // Identifies the trial within its list and seeds its noise. Even; the fixed
  // twin has the next number.
  uint64_t number = 0;
};

ContactScene SceneOf(const TrialSpec& spec);

// The same trial with the object fixed.
TrialSpec FixedTwin(const TrialSpec& spec);

}  // namespace tactus::internal
