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
  const double place = random.Uniform();
  // 0 has no logarithm.
  return low == high ? low : low * std::exp(place * std::log(high / low));
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

TrialSpec DrawSpec(uint64_t number, Random& random) {
  TrialSpec spec;
  spec.number = number;
  spec.object.material = DrawMaterial(random);
  spec.object.edge_m = random.Uniform(0.01, 0.2);
  spec.fixed = random.Index(2) == 0;
  spec.robot = DrawRobot(random);
  const double approach = random.Uniform();
  if (random.Index(2) == 0) spec.approach_s = approach;
  return spec;
}

// Labels and groups of a contact of the world.
void Describe(const TrialSpec& spec, Trial& trial) {
  const bool moved = trial.object_motion.back() > kWorldMovedM;
  trial.label.back() = moved ? 'M' : 'U';
  trial.condition = absl::StrFormat(
      "k%d-v2^%d", 1 << static_cast<int>(std::log2(spec.robot.stiffness)),
      static_cast<int>(std::floor(std::log2(spec.robot.velocity))));
}

}  // namespace

WorldContact DrawWorldContact(const SkinModel& skin, uint64_t seed,
                              uint64_t number, Random& random) {
  random = Random::ForStream(seed, kWorldStream + number);
  WorldContact contact;
  contact.spec = DrawSpec(number, random);
  contact.placement = DrawPlacement(skin.layout, random);
  contact.placement.pose_noise_m =
      LogUniformBetween(skin.pose_noise_min_m, skin.pose_noise_max_m, random);
  contact.placement.pose_gain_error =
      random.Uniform(-skin.pose_gain_error_max, skin.pose_gain_error_max);
  return contact;
}

absl::StatusOr<Trial> WorldTrial(const SkinModel& skin, uint64_t seed,
                                 uint64_t number) {
  Random random(0);
  const WorldContact drawn = DrawWorldContact(skin, seed, number, random);
  TACTUS_ASSIGN_OR_RETURN(const SimulatedContact contact,
                          SimulateContact(drawn.spec));
  Trial trial = RecordContact(contact, skin, drawn.placement, random);
  Describe(drawn.spec, trial);
  return trial;
}

absl::StatusOr<Trial> WorldSignals(const SignalNoise& noise, uint64_t seed,
                                   uint64_t number) {
  Random random = Random::ForStream(seed, kWorldStream + number);
  const TrialSpec spec = DrawSpec(number, random);
  TACTUS_ASSIGN_OR_RETURN(const SimulatedContact contact,
                          SimulateContact(spec));
  Trial trial = SignalTrial(contact, noise, seed);
  Describe(spec, trial);
  return trial;
}

}  // namespace tactus
