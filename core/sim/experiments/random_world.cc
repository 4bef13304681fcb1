#include "core/sim/experiments/random_world.h"

#include "core/base/status_macros.h"
#include "core/sim/exact/simulate_contact.h"
#include "core/sim/experiments/world_draws.h"

namespace tactus::internal {
namespace {

// Contacts come from other streams than the noise of other protocols.
constexpr uint64_t kWorldStream = uint64_t{1} << 33;

TrialSpec DrawSpec(uint64_t number, Random& random) {
  TrialSpec spec;
  spec.number = number;
  DrawWorldObject(random, spec);
  DrawWorldArm(random, spec);
  return spec;
}

// Labels and groups of a contact of the world.
void Describe(const TrialSpec& spec, Trial& trial) {
  const bool moved = trial.object_motion.back() > kWorldMovedM;
  trial.label.back() = moved ? 'M' : 'U';
  trial.condition = WorldCondition(spec.robot);
}

}  // namespace

WorldContact DrawWorldContact(const SkinModel& skin, uint64_t seed,
                              uint64_t number, Random& random) {
  random = Random::ForStream(seed, kWorldStream + number);
  WorldContact contact;
  contact.spec = DrawSpec(number, random);
  contact.placement = DrawPlacement(skin.layout, random);
  DrawPoseErrors(skin, random, contact.placement);
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

}  // namespace tactus::internal
