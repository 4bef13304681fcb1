#include "core/sim/experiments/random_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/sim/coupled/press_together.h"
#include "core/sim/exact/simulate_contact.h"
#include "core/sim/experiments/link_path.h"
#include "core/sim/experiments/random_world.h"
#include "core/sim/experiments/world_draws.h"
#include "core/sim/skin/block_filter.h"
#include "core/sim/skin/record_contacts.h"

namespace tactus::internal {
namespace {

// Trials come from other streams than the contacts of the world.
constexpr uint64_t kSceneStream = uint64_t{1} << 36;
constexpr double kOnsetSpanS = 2;
// Objects at once begin within this share of the first one's duration and of
// the way to the goal.
constexpr double kOnsetShare = 0.9;
constexpr double kOnsetWayShare = 0.7;
// The arm comes to rest, or turns to the next object, within this time after
// a contact, s.
constexpr double kTurnS = 0.5;
// Simulated beyond the time at which the equilibrium point is back at the
// touch: the arm follows it within a second, and then turns.
constexpr double kAfterRetreatS = 2;

size_t Frames(double seconds) {
  return static_cast<size_t>(std::lround(seconds * kSkinRateHz));
}

// One object's contact, as drawn.
struct DrawnTouch {
  TrialSpec spec;
  SkinPoint centre;
  double tilt_rad = 0;
  // When the arm reaches one of several objects at once, s after the first
  // touch, and how far it then has come, m.
  double onset_s = 0;
  double distance_m = 0;
};

struct DrawnScene {
  Placement placement;
  std::vector<DrawnTouch> touches;
};

// Sets the lift-off `after_s` after the touch.
void DrawRetreat(double after_s, double touch_s, Random& random,
                 TrialSpec& spec) {
  const ContactScene scene = SceneOf(spec);
  const double way =
      std::min(scene.goal_m, scene.lead_m + scene.velocity_m_s * after_s);
  spec.retreat_after_s = after_s;
  spec.retreat_speed_m_s = std::max(
      spec.robot.velocity * LogUniformBetween(1, 4, random), 2 * way / touch_s);
  spec.duration_s = after_s + way / spec.retreat_speed_m_s + kAfterRetreatS;
}

DrawnTouch DrawTouch(const SkinLayout& layout, const TrialSpec& arm,
                     Random& random) {
  DrawnTouch touch;
  touch.spec = arm;
  DrawWorldObject(random, touch.spec);
  const Placement placement = DrawPlacement(layout, random);
  touch.centre = placement.centre;
  touch.tilt_rad = placement.tilt_rad;
  return touch;
}

void DrawSequence(const SkinModel& skin, const SceneOptions& options,
                  const TrialSpec& arm, Random& random, DrawnScene& scene) {
  // Between its turn and the next touch the arm has this much time.
  const double turn_s = std::min(options.gap_s, kTurnS);
  for (int i = 0; i < options.touches; ++i) {
    DrawnTouch touch = DrawTouch(skin.layout, arm, random);
    if (i > 0) {
      touch.spec.approach_s =
          std::min(arm.approach_s, options.gap_s - turn_s / 2);
    }
    DrawRetreat(options.touch_s, options.touch_s, random, touch.spec);
    scene.touches.push_back(std::move(touch));
  }
}

// A place `distance_m` from `centre` in a random direction, on the skin.
SkinPoint DrawPlaceNear(const SkinLayout& layout, const SkinPoint& centre,
                        double distance_m, Random& random) {
  const double angle = random.Uniform(0, 2 * std::numbers::pi);
  SkinPoint place;
  place.row =
      std::clamp(centre.row + distance_m * std::sin(angle) / layout.row_pitch_m,
                 0.0, layout.rows - 1.0);
  const double columns = layout.columns;
  place.column =
      centre.column + distance_m * std::cos(angle) / layout.column_pitch_m;
  place.column =
      layout.wrap_columns
          ? place.column - columns * std::floor(place.column / columns)
          : std::clamp(place.column, 0.0, columns - 1);
  return place;
}

void DrawPlaces(const SkinLayout& layout, Random& random, DrawnScene& scene) {
  DrawnTouch& first = scene.touches.front();
  const bool at_seam = random.Index(4) == 0;
  if (at_seam && layout.wrap_columns) {
    const double column = random.Uniform(-0.5, 0.5);
    first.centre.column = column < 0 ? column + layout.columns : column;
  }
  for (size_t i = 1; i < scene.touches.size(); ++i) {
    DrawnTouch& touch = scene.touches[i];
    const uint64_t relation = random.Index(4);
    const double share =
        relation == 0 ? random.Uniform(0.2, 0.8) : random.Uniform(1, 1.5);
    if (relation >= 2) continue;
    // Two faces whose middles are this far apart meet at their edges.
    const double meet =
        (first.spec.object.edge_m + touch.spec.object.edge_m) / 2;
    touch.centre = DrawPlaceNear(layout, first.centre, share * meet, random);
  }
}

void DrawTogether(const SkinModel& skin, const SceneOptions& options,
                  const TrialSpec& arm, Random& random, DrawnScene& scene) {
  const double way_s = SceneOf(arm).RampEnd();
  double first_s = 0;
  double until_s = 0;
  for (int i = 0; i < options.objects; ++i) {
    DrawnTouch touch = DrawTouch(skin.layout, arm, random);
    const double lasts_s = options.touch_s * random.Uniform(0.5, 1.5);
    const double onset = random.Uniform();
    if (i == 0) first_s = lasts_s;
    if (i > 0) {
      touch.onset_s = onset * std::min({kOnsetSpanS, kOnsetShare * first_s,
                                        kOnsetWayShare * way_s});
    }
    until_s = std::max(until_s, touch.onset_s + lasts_s);
    scene.touches.push_back(std::move(touch));
  }
  TrialSpec retreat = arm;
  DrawRetreat(until_s, options.touch_s, random, retreat);
  for (DrawnTouch& touch : scene.touches) {
    touch.spec.retreat_after_s = retreat.retreat_after_s;
    touch.spec.retreat_speed_m_s = retreat.retreat_speed_m_s;
    touch.spec.duration_s = retreat.duration_s;
  }
  DrawPlaces(skin.layout, random, scene);
  std::sort(scene.touches.begin(), scene.touches.end(),
            [](const DrawnTouch& a, const DrawnTouch& b) {
              return a.onset_s < b.onset_s;
            });
}

DrawnScene DrawScene(const SkinModel& skin, const SceneOptions& options,
                     uint64_t number, Random& random) {
  DrawnScene scene;
  TrialSpec arm;
  arm.number = number;
  DrawWorldArm(random, arm);
  DrawPoseErrors(skin, random, scene.placement);
  if (options.objects > 1) {
    DrawTogether(skin, options, arm, random, scene);
  } else {
    DrawSequence(skin, options, arm, random, scene);
  }
  return scene;
}

// Finds the samples with load, at least one: a short train of bounces may fall
// between the samples. NUMERICAL_FAILURE if the last sample is one: then the
// arm has not let go.
absl::Status FindLoad(const SimulatedContact& contact, PlacedContact& placed) {
  const auto& samples = contact.signals.samples;
  const auto loaded = [](const FeatureVector& sample) {
    return sample[static_cast<int>(Feature::kForce)] >= kLeastLoadN;
  };
  const auto first = std::find_if(samples.begin(), samples.end(), loaded);
  const auto last = std::find_if(samples.rbegin(), samples.rend(), loaded);
  placed.begin_sample = 0;
  placed.end_sample = 1;
  if (first == samples.end()) return absl::OkStatus();
  if (last == samples.rbegin()) {
    return NumericalFailure("a simulated arm does not let go of its object");
  }
  placed.begin_sample = static_cast<size_t>(first - samples.begin());
  placed.end_sample = static_cast<size_t>(samples.rend() - last);
  return absl::OkStatus();
}

size_t FirstFrame(const PlacedContact& placed) {
  return placed.begin_frame + placed.begin_sample;
}

size_t LastFrame(const PlacedContact& placed) {
  return placed.begin_frame + placed.end_sample - 1;
}

Touch TruthOf(const PlacedContact& placed) {
  const SimulatedContact& contact = *placed.contact;
  const Trial metadata = contact.Metadata();
  const auto& motion = contact.signals.object_motion;
  Touch touch;
  touch.begin_s = static_cast<double>(FirstFrame(placed)) / kSkinRateHz;
  touch.end_s = static_cast<double>(LastFrame(placed)) / kSkinRateHz;
  touch.centre = placed.centre;
  touch.object = metadata.object;
  touch.material = metadata.material;
  touch.stiffness = metadata.stiffness;
  touch.object_motion.assign(
      motion.begin() + static_cast<ptrdiff_t>(placed.begin_sample),
      motion.begin() + static_cast<ptrdiff_t>(placed.end_sample));
  touch.label =
      absl::StrCat(contact.hard() ? "H" : "S",
                   touch.object_motion.back() > kWorldMovedM ? "M" : "U");
  return touch;
}

// Says of the trial what it says of its first touch.
Trial MetadataOf(const std::vector<SimulatedContact>& contacts,
                 const std::vector<PlacedContact>& placed) {
  Trial trial = contacts.front().Metadata();
  for (const PlacedContact& contact : placed) {
    trial.touches.push_back(TruthOf(contact));
  }
  std::stable_sort(
      trial.touches.begin(), trial.touches.end(),
      [](const Touch& a, const Touch& b) { return a.begin_s < b.begin_s; });
  const Touch& first = trial.touches.front();
  trial.label = first.label;
  trial.object = first.object;
  trial.material = first.material;
  trial.stiffness = first.stiffness;
  trial.condition = WorldCondition(contacts.front().spec.robot);
  return trial;
}

// Puts each object where the arm is at its onset, held back by those before.
absl::Status SetDistances(DrawnScene& scene) {
  std::vector<PressedObject> before = {{.spec = scene.touches.front().spec}};
  for (size_t i = 1; i < scene.touches.size(); ++i) {
    DrawnTouch& touch = scene.touches[i];
    TACTUS_ASSIGN_OR_RETURN(const double place,
                            ArmAfter(touch.onset_s, before));
    // An arm that has bounced off may be behind its start.
    touch.distance_m = std::max(place, 0.0);
    before.push_back({touch.spec, touch.distance_m});
  }
  return absl::OkStatus();
}

absl::StatusOr<DrawnScene> DrawWithDistances(const SkinModel& skin,
                                             const SceneOptions& options,
                                             uint64_t number, Random& random) {
  DrawnScene scene = DrawScene(skin, options, number, random);
  if (options.objects > 1) TACTUS_RETURN_IF_ERROR(SetDistances(scene));
  return scene;
}

// One for each touch of the scene.
absl::StatusOr<std::vector<SimulatedContact>> Simulate(
    const DrawnScene& scene, const SceneOptions& options) {
  std::vector<SimulatedContact> contacts;
  if (options.objects > 1) {
    std::vector<PressedObject> objects;
    for (const DrawnTouch& touch : scene.touches) {
      objects.push_back({touch.spec, touch.distance_m});
    }
    return PressTogether(objects);
  }
  for (const DrawnTouch& touch : scene.touches) {
    TACTUS_ASSIGN_OR_RETURN(contacts.emplace_back(),
                            SimulateContact(touch.spec));
  }
  return contacts;
}

// Records the contacts of the scene's touches.
absl::StatusOr<Trial> Record(const DrawnScene& scene,
                             const std::vector<SimulatedContact>& contacts,
                             const SkinModel& skin, const SceneOptions& options,
                             Random& random) {
  const size_t lead_in = scene.placement.lead_in_frames;
  const bool together = options.objects > 1;
  std::vector<PlacedContact> placed;
  size_t end = 0;
  for (size_t i = 0; i < contacts.size(); ++i) {
    PlacedContact contact = {.contact = &contacts[i],
                             .centre = scene.touches[i].centre,
                             .tilt_rad = scene.touches[i].tilt_rad,
                             .begin_frame = lead_in};
    TACTUS_RETURN_IF_ERROR(FindLoad(contacts[i], contact));
    if (!together && i > 0) {
      contact.begin_frame = LastFrame(placed.back()) + Frames(options.gap_s) +
                            1 - contact.begin_sample;
    }
    end = std::max(end, LastFrame(contact) + 1);
    placed.push_back(contact);
  }

  LinkPath path(skin.layout, placed.front());
  const PlacedContact* last = &placed.front();
  for (size_t i = 1; i < placed.size() && !together; ++i) {
    path.Follow(LastFrame(*last), Frames(std::min(options.gap_s, kTurnS)),
                placed[i]);
    last = &placed[i];
  }
  path.Rest(together ? end - 1 : LastFrame(*last), Frames(kTurnS));
  const LinkMotion motion = {
      .steps = path.Steps(end + Frames(kSceneIdleS)),
      .pose_noise_m = scene.placement.pose_noise_m,
      .pose_gain_error = scene.placement.pose_gain_error};
  return RecordContacts(MetadataOf(contacts, placed), placed, skin, motion,
                        random);
}

}  // namespace

absl::Status Validate(const SceneOptions& options) {
  const int most = static_cast<int>(limits::kMaxTouchesPerTrial);
  if (options.touches < 1 || options.touches > most) {
    return InvalidConfig("touches", options.touches,
                         absl::StrCat("1 to ", most));
  }
  if (options.objects < 1 || options.objects > limits::kMaxSceneObjects) {
    return InvalidConfig("objects", options.objects,
                         absl::StrCat("1 to ", limits::kMaxSceneObjects));
  }
  if (options.touches > 1 && options.objects > 1) {
    return InvalidConfig("objects with several touches", options.objects,
                         "1: objects press one after the other or at once");
  }
  // Written so that a NaN fails.
  if (!(options.gap_s >= 1 / kSkinRateHz && options.gap_s <= 10)) {
    return InvalidConfig("gap", options.gap_s, "0.01 to 10 s");
  }
  if (!(options.touch_s >= 0.1 && options.touch_s <= 20)) {
    return InvalidConfig("touch-seconds", options.touch_s, "0.1 to 20 s");
  }
  return absl::OkStatus();
}

absl::StatusOr<Trial> SceneTrial(const SkinModel& skin,
                                 const SceneOptions& options, uint64_t seed,
                                 uint64_t number) {
  TACTUS_RETURN_IF_ERROR(Validate(options));
  Random random = Random::ForStream(seed, kSceneStream + number);
  TACTUS_ASSIGN_OR_RETURN(const DrawnScene scene,
                          DrawWithDistances(skin, options, number, random));
  TACTUS_ASSIGN_OR_RETURN(const auto contacts, Simulate(scene, options));
  return Record(scene, contacts, skin, options, random);
}

absl::StatusOr<std::vector<Trial>> SceneTrialsAlone(const SkinModel& skin,
                                                    const SceneOptions& options,
                                                    uint64_t seed,
                                                    uint64_t number) {
  TACTUS_RETURN_IF_ERROR(Validate(options));
  Random random = Random::ForStream(seed, kSceneStream + number);
  TACTUS_ASSIGN_OR_RETURN(const DrawnScene scene,
                          DrawWithDistances(skin, options, number, random));
  const auto count = static_cast<uint64_t>(scene.touches.size());
  std::vector<Trial> trials;
  for (uint64_t i = 0; i < count; ++i) {
    DrawnScene alone = {.placement = scene.placement,
                        .touches = {scene.touches[i]}};
    alone.touches.front().spec.number = number * count + i;
    TACTUS_ASSIGN_OR_RETURN(const auto contacts, Simulate(alone, options));
    TACTUS_ASSIGN_OR_RETURN(trials.emplace_back(),
                            Record(alone, contacts, skin, options, random));
  }
  return trials;
}

}  // namespace tactus::internal
