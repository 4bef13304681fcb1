#include "client/drivers/sim_driver.h"

#include "absl/strings/str_format.h"
#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/base/status_macros.h"
#include "core/sim/exact/simulate_contact.h"
#include "core/sim/experiments/random_scene.h"
#include "core/sim/model/materials.h"
#include "core/sim/model/trial_spec.h"
#include "core/sim/skin/record_contact.h"
#include "core/sim/skin/skin_model.h"

namespace tactus::internal::client {
namespace {

constexpr absl::string_view kLabels[] = {"HU", "HM", "SU", "SM"};
// An object that moved by no more is unmoved, m.
constexpr double kMovedM = 0.001;
// Draws until the class wanted comes up; one in ten does at worst.
constexpr int kMaxDraws = 1000;
constexpr int kEdges = 10;
// Long enough for objects that slip late, s.
constexpr double kSceneTouchS = 3;

TrialSpec Draw(Random& random) {
  const auto materials = Materials();
  TrialSpec spec;
  spec.object.material = materials[random.Index(materials.size())];
  spec.object.edge_m =
      0.01 + 0.19 / (kEdges - 1) * static_cast<double>(random.Index(kEdges));
  spec.object.surface =
      random.Uniform() < 0.5 ? Surface::kWood : Surface::kGlass;
  // Well inside the paper's corners, 543 to 2050 N/m and 5 to 20 mm/s.
  spec.robot.stiffness = random.Uniform(750, 1850);
  spec.robot.velocity = random.Uniform(0.007, 0.018);
  spec.fixed = random.Uniform() < 0.25;
  return spec;
}

}  // namespace

absl::StatusOr<Trial> SimDriver::MakeTrial(size_t index) {
  const absl::string_view want = kLabels[index % std::size(kLabels)];
  TACTUS_ASSIGN_OR_RETURN(const SkinModel skin, SkinModelNamed(options_.skin));
  if (options_.objects > 1) {
    return SceneTrial(skin,
                      {.touch_s = kSceneTouchS, .objects = options_.objects},
                      options_.seed, index);
  }
  Random random = Random::ForStream(options_.seed, index);
  for (int draw = 0; draw < kMaxDraws; ++draw) {
    TrialSpec spec = Draw(random);
    // Known before the simulation is run.
    const bool hard = spec.object.Stiffness() >= kHardStiffness;
    if (hard != (want[0] == 'H') || (spec.fixed && want[1] == 'M')) continue;
    spec.number = index;
    TACTUS_ASSIGN_OR_RETURN(const SimulatedContact contact,
                            SimulateContact(spec));
    const bool moved = contact.signals.object_motion.back() > kMovedM;
    if (moved != (want[1] == 'M')) continue;
    Placement placement = DrawPlacement(skin.layout, random);
    if (options_.centre) placement.centre = *options_.centre;
    if (options_.lead_in_frames > 0) {
      placement.lead_in_frames = options_.lead_in_frames;
    }
    Trial trial = RecordContact(contact, skin, placement, random);
    trial.label = std::string(want);
    trial.id = absl::StrFormat("%06d", index);
    return trial;
  }
  return NumericalFailure(absl::StrFormat(
      "no simulated contact of class %s in %d draws", want, kMaxDraws));
}

}  // namespace tactus::internal::client
