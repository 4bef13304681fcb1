#include "core/sim/experiments/random_world.h"

#include <cmath>

#include "absl/strings/str_format.h"
#include "core/base/status_macros.h"
#include "core/sim/exact/simulate_contact.h"

namespace tactus {
namespace {

// Contacts come from other streams than the noise of other protocols.
constexpr uint64_t kWorldStream = uint64_t{1} << 33;

double LogUniformBetween(double low, double high, Random& random) {
  return low * std::exp(random.Uniform() * std::log(high / low));
}

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

WorldContact DrawWorldContact(const SkinLayout& layout, uint64_t seed,
                              uint64_t number, Random& random) {
  random = Random::ForStream(seed, kWorldStream + number);
  WorldContact contact;
  contact.spec.number = number;
  contact.spec.object.material = DrawMaterial(random);
  contact.spec.object.edge_m = random.Uniform(0.01, 0.1);
  contact.spec.fixed = random.Index(2) == 0;
  contact.spec.robot = DrawRobot(random);
  const double approach = random.Uniform();
  if (random.Index(2) == 0) contact.spec.approach_s = approach;
  contact.placement = DrawPlacement(layout, random);
  contact.placement.pose_noise_m = LogUniformBetween(5e-5, 2e-3, random);
  contact.placement.pose_gain_error = random.Uniform(-0.02, 0.02);
  return contact;
}

absl::StatusOr<Trial> WorldTrial(const SkinModel& skin, uint64_t seed,
                                 uint64_t number) {
  Random random(0);
  const WorldContact drawn =
      DrawWorldContact(skin.layout, seed, number, random);
  TACTUS_ASSIGN_OR_RETURN(const SimulatedContact contact,
                          SimulateContact(drawn.spec));
  Trial trial = RecordContact(contact, skin, drawn.placement, random);
  const RobotCondition& robot = drawn.spec.robot;
  trial.condition = absl::StrFormat(
      "k%d-v2^%d", 1 << static_cast<int>(std::log2(robot.stiffness)),
      static_cast<int>(std::floor(std::log2(robot.velocity))));
  return trial;
}

}  // namespace tactus
