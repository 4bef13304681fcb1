#include "core/sim/experiments/world_draws.h"

#include <cmath>

#include "absl/strings/str_format.h"

namespace tactus::internal {
namespace {

Material DrawMaterial(Random& random) {
  Material material;
  material.youngs_modulus = LogUniformBetween(2e3, 6e10, random);
  material.density = LogUniformBetween(30, 8000, random);
  material.wood.mu_static = random.Uniform(0.12, 0.95);
  material.wood.mu_kinetic =
      material.wood.mu_static * random.Uniform(0.6, 0.95);
  material.glass = material.wood;
  material.poisson_ratio = random.Uniform(0.2, 0.49);
  material.name = absl::StrFormat(
      "E1e%d-d2^%d",
      static_cast<int>(std::floor(std::log10(material.youngs_modulus))),
      static_cast<int>(std::floor(std::log2(material.density))));
  return material;
}

RobotCondition DrawRobot(Random& random) {
  RobotCondition robot;
  robot.stiffness = LogUniformBetween(543 / 4.0, 2050 * 4.0, random);
  robot.velocity = LogUniformBetween(0.005 / 4, 0.02 * 4, random);
  robot.goal_m = LogUniformBetween(kPaperGoal / 4, kPaperGoal * 4, random);
  return robot;
}

}  // namespace

double LogUniformBetween(double low, double high, Random& random) {
  const double place = random.Uniform();
  // 0 has no logarithm.
  return low == high ? low : low * std::exp(place * std::log(high / low));
}

void DrawWorldObject(Random& random, TrialSpec& spec) {
  spec.object.material = DrawMaterial(random);
  spec.object.edge_m = random.Uniform(0.01, 0.2);
  spec.fixed = random.Index(2) == 0;
}

void DrawWorldArm(Random& random, TrialSpec& spec) {
  spec.robot = DrawRobot(random);
  const double approach = random.Uniform();
  if (random.Index(2) == 0) spec.approach_s = approach;
}

void DrawPoseErrors(const SkinModel& skin, Random& random,
                    Placement& placement) {
  placement.pose_noise_m =
      LogUniformBetween(skin.pose_noise_min_m, skin.pose_noise_max_m, random);
  placement.pose_gain_error =
      random.Uniform(-skin.pose_gain_error_max, skin.pose_gain_error_max);
}

std::string WorldCondition(const RobotCondition& robot) {
  return absl::StrFormat(
      "k%d-v2^%d", 1 << static_cast<int>(std::log2(robot.stiffness)),
      static_cast<int>(std::floor(std::log2(robot.velocity))));
}

}  // namespace tactus::internal
