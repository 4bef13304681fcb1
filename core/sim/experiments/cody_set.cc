#include "core/sim/experiments/cody_set.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/random.h"
#include "core/features/contact_tracker.h"
#include "core/sim/skin/block_filter.h"
#include "core/sim/skin/record_contact.h"

namespace tactus::internal {
namespace {

// Name, hard, movable, stiffness, mass, friction. The free ones yield to less
// than the 0.6 N that the most compliant, slowest arm reaches within the
// window: in the paper, all of them moved.
constexpr CodyObject kObjects[] = {
    {"foliage", false, true, 630, 0.10, {0.50, 0.40}},
    {"foam-block", false, true, 850, 0.05, {0.60, 0.48}},
    {"sponge-roll", false, true, 1150, 0.08, {0.55, 0.44}},
    {"stuffed-toy", false, true, 1500, 0.11, {0.45, 0.36}},
    {"polystyrene-cylinder", true, true, 8e3, 0.06, {0.45, 0.36}},
    {"plastic-bin", true, true, 3e4, 0.15, {0.30, 0.24}},
    {"balsa-box", true, true, 1e5, 0.12, {0.40, 0.32}},
    {"iron-bucket", true, false, 2e5, 8.00, {0.60, 0.48}},
};

constexpr double kJointStiffnesses[] = {2.01, 20.1};  // Nm/rad
constexpr double kJointVelocities[] = {5, 20};        // deg/s

// The stretched arm: shoulder to elbow, elbow to the first row of skin.
constexpr double kUpperArmM = 0.28;
constexpr double kElbowToSkinM = 0.05;
// The shoulder's goal, past the angle of first contact.
constexpr double kGoalDeg = 15;

// What differs between repetitions, drawn evenly. The object meets the
// forearm in this middle part, on the side towards its motion.
constexpr double kFirstRow = 4;
constexpr double kLastRow = 11;
constexpr double kFirstColumn = 4;
constexpr double kLastColumn = 8;
// Where the object stands: angle of first contact, +- deg.
constexpr double kPlacementDeg = 2;
// Edge of the face, m, and Poisson's ratio, of soft and hard objects alike.
constexpr double kSmallestFace = 0.03;
constexpr double kLargestFace = 0.06;
constexpr double kSmallestPoisson = 0.27;
constexpr double kLargestPoisson = 0.40;
// Relative differences, +-.
constexpr double kMassShare = 0.02;
constexpr double kFrictionShare = 0.15;

// Apart from the streams of the trials' noise.
constexpr uint64_t kCodyStream = uint64_t{1} << 33;
constexpr uint64_t kCodySkinStream = uint64_t{1} << 35;

double Radians(double degrees) { return degrees * std::numbers::pi / 180; }

// The object as a cube with its mass, stiffness and face.
Cube CubeOf(const CodyObject& object, Random& random) {
  const double edge = random.Uniform(kSmallestFace, kLargestFace);
  const double mass =
      object.mass_kg * random.Uniform(1 - kMassShare, 1 + kMassShare);
  const double grip = random.Uniform(1 - kFrictionShare, 1 + kFrictionShare);
  const Friction table = {object.table.mu_static * grip,
                          object.table.mu_kinetic * grip};
  Material material;
  material.name = object.name;
  material.youngs_modulus = object.stiffness / (2 * edge);
  material.density = mass / (edge * edge * edge);
  material.wood = table;
  material.glass = table;
  material.poisson_ratio = random.Uniform(kSmallestPoisson, kLargestPoisson);
  return {material, edge, Surface::kWood};
}

CodySpec DrawSpec(const CodyObject& object, double joint_stiffness,
                  double joint_velocity, bool held, uint64_t number,
                  const SkinLayout& layout, uint64_t seed) {
  Random random = Random::ForStream(seed, kCodyStream + number);
  CodySpec spec;
  spec.object = object;
  spec.joint_stiffness = joint_stiffness;
  spec.joint_velocity = joint_velocity;
  spec.centre.row = random.Uniform(kFirstRow, kLastRow);
  spec.centre.column = random.Uniform(kFirstColumn, kLastColumn);
  const double lever = CodyLeverArm(layout, spec.centre.row);
  const double goal_deg =
      kGoalDeg + random.Uniform(-kPlacementDeg, kPlacementDeg);
  spec.contact.object = CubeOf(object, random);
  spec.contact.robot = {joint_stiffness / (lever * lever),
                        Radians(joint_velocity) * lever,
                        Radians(goal_deg) * lever};
  spec.contact.fixed = held;
  spec.contact.number = number;
  return spec;
}

size_t WindowFrames() {
  return static_cast<size_t>(std::lround(kCodyWindowS * kSkinRateHz));
}

// The frame at which the feature path begins a contact, or `otherwise`.
size_t OnsetFrame(const Trial& trial, const SkinLayout& layout,
                  size_t otherwise) {
  ContactTracker tracker(layout, {.sample_rate_hz = kSkinRateHz});
  std::vector<float> taxels(layout.taxels());
  for (size_t t = 0; t < trial.taxels.frames(); ++t) {
    trial.taxels.Decode(t, taxels.data());
    tracker.Step({.taxels = taxels});
    if (tracker.onset()) return t;
  }
  return otherwise;
}

// `trial` is that of the window, so its end is the window's.
void Describe(const CodySpec& spec, Trial& trial) {
  const bool moved = trial.object_motion.back() > kCodyMovedM;
  trial.label = absl::StrCat(spec.object.hard ? "H" : "S", moved ? "M" : "U");
  trial.condition = absl::StrFormat("k%gNm-w%gdeg", spec.joint_stiffness,
                                    spec.joint_velocity);
  trial.material = spec.object.name;
  trial.object =
      absl::StrCat(spec.object.name, spec.contact.fixed ? "-held" : "");
}

}  // namespace

std::span<const CodyObject> CodyObjects() { return kObjects; }

double CodyLeverArm(const SkinLayout& layout, double row) {
  return kUpperArmM + kElbowToSkinM + row * layout.row_pitch_m;
}

std::vector<CodySpec> CodySpecs(const SkinLayout& layout, uint64_t seed) {
  std::vector<CodySpec> specs;
  for (double stiffness : kJointStiffnesses) {
    for (double velocity : kJointVelocities) {
      for (const CodyObject& object : CodyObjects()) {
        for (bool held : {false, true}) {
          if (!held && !object.movable) continue;
          for (int i = 0; i < kCodyRepetitions; ++i) {
            specs.push_back(DrawSpec(object, stiffness, velocity, held,
                                     specs.size(), layout, seed));
          }
        }
      }
    }
  }
  return specs;
}

absl::StatusOr<Trial> CodySignalTrial(const CodySpec& spec,
                                      const SimulatedContact& contact,
                                      const SignalNoise& noise, uint64_t seed) {
  Trial trial = SignalTrial(contact, noise, seed);
  const size_t frames = std::min(WindowFrames(), trial.time.size());
  trial.time.resize(frames);
  trial.signals.resize(frames);
  trial.object_motion.resize(frames);
  Describe(spec, trial);
  return trial;
}

absl::StatusOr<Trial> CodySkinTrial(const CodySpec& spec,
                                    const SimulatedContact& contact,
                                    const SkinModel& skin, uint64_t seed) {
  Random random =
      Random::ForStream(seed, kCodySkinStream + contact.spec.number);
  Placement placement = DrawPlacement(skin.layout, random);
  placement.centre = spec.centre;
  Trial trial = RecordContact(contact, skin, placement, random);
  const size_t touch = placement.lead_in_frames;
  const size_t frames =
      std::min(OnsetFrame(trial, skin.layout, touch) + WindowFrames(),
               trial.time.size());
  trial.time.resize(frames);
  trial.poses.resize(frames);
  trial.object_motion.resize(frames);
  const size_t readings = frames * skin.layout.taxels();
  if (trial.taxels.u16.empty()) {
    trial.taxels.f32.resize(readings);
  } else {
    trial.taxels.u16.resize(readings);
  }
  Describe(spec, trial);
  return trial;
}

}  // namespace tactus::internal
