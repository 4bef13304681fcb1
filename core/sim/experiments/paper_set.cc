#include "core/sim/experiments/paper_set.h"

namespace tactus {
namespace {

constexpr int kEdges = 10;
constexpr double kSmallestEdge = 0.01;  // m
constexpr double kLargestEdge = 0.2;

}  // namespace

std::vector<RobotCondition> PaperConditions(double goal_m) {
  std::vector<RobotCondition> conditions;
  for (double stiffness : {543.0, 2050.0}) {
    for (double velocity : {0.005, 0.02}) {
      conditions.push_back({stiffness, velocity, goal_m});
    }
  }
  return conditions;
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

}  // namespace tactus
