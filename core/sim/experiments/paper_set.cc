#include "core/sim/experiments/paper_set.h"

namespace tactus::internal {
namespace {

constexpr int kEdges = 10;
constexpr double kSmallestEdge = 0.01;  // m
constexpr double kLargestEdge = 0.2;

}  // namespace

std::vector<RobotCondition> RobotGrid::Conditions() const {
  std::vector<RobotCondition> conditions;
  for (double stiffness : stiffnesses) {
    for (double velocity : velocities) {
      for (double goal : goals) {
        conditions.push_back({stiffness, velocity, goal});
      }
    }
  }
  return conditions;
}

RobotGrid PaperGrid() {
  return {.stiffnesses = {543, 2050},
          .velocities = {0.005, 0.02},
          .goals = {kPaperGoal}};
}

std::vector<TrialSpec> TrialSpecs(const std::vector<RobotCondition>& robots,
                                  std::span<const Material> materials) {
  std::vector<TrialSpec> specs;
  for (const RobotCondition& robot : robots) {
    for (const Material& material : materials) {
      for (int i = 0; i < kEdges; ++i) {
        const double edge =
            kSmallestEdge + i * (kLargestEdge - kSmallestEdge) / (kEdges - 1);
        for (Surface surface : {Surface::kWood, Surface::kGlass}) {
          TrialSpec spec;
          spec.object = {material, edge, surface};
          spec.robot = robot;
          spec.number = 2 * specs.size();
          specs.push_back(spec);
        }
      }
    }
  }
  return specs;
}

}  // namespace tactus::internal
