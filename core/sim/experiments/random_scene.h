// File: random_scene.h
//
// Random trials with several contacts, each object drawn independently from the
// random world (random_world.h). Either one arm touches one object after the
// other and lets go in between, or it presses several objects at once.
//
//   const SceneOptions options = {.touches = 2, .gap_s = 0.25};
//   TACTUS_ASSIGN_OR_RETURN(Trial trial,
//                           SceneTrial(skin, options, seed, number));
//   trial.touches[1].label;  // "HM"
//
// | drawn | how |
// |---|---|
// | objects, places, tilts | each as in the random world |
// | arm, errors of the poses | once for a trial, as in the random world |
// | approach | as in the world; later ones fit into the gap |
// | retreat | 1 to 4 times the arm's speed, log-uniform; faster if the way |
// | | back would take more than half a touch |
// | objects at once: onset | up to 2 s after the first, uniform, but within |
// | | 0.9 of the first one's duration and 0.7 of the way to the goal |
// | duration | 0.5 to 1.5 times touch_s, uniform; the arm lifts off after |
// | | the longest |
// | place of the first | 1/4 at the seam, if the skin is a cylinder |
// | places of the others | 1/2 anywhere, 1/4 beside the first, 1/4 over it |
//
// Objects at once are pressed by one arm (press_together.h): each lies where
// the arm would be at its onset, pressing those before, and all hold the arm
// back. The arm moves along the first one's normal.
//
// Trial n is a function of seed and n: workers share nothing. Stateless;
// thread-safe.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/data/trial.h"
#include "core/sim/skin/skin_model.h"

namespace tactus::internal {

// A load below this is none, N: the rest of the anti-aliasing filter's answer
// after a contact was lost. The best skin's noise is as large.
inline constexpr double kLeastLoadN = 1e-6;
// Idle skin after the last touch, s. Before the first one there is as much
// (Placement::lead_in_frames).
inline constexpr double kSceneIdleS = 1;

struct SceneOptions {
  // Contacts one after the other, 1 to limits::kMaxTouchesPerTrial.
  int touches = 1;
  // Seconds without load between two of them, 0.01 to 10; whole frames.
  double gap_s = 0.25;
  // From a touch to the start of the lift-off, s, 0.1 to 20.
  double touch_s = 2;
  // Objects at overlapping times, 1 to 4; only with one touch.
  int objects = 1;
};

// OK if every field is in range; else INVALID_CONFIG naming the field.
absl::Status Validate(const SceneOptions& options);

// Simulates and records trial `number`. Its touches have the simulation's
// truth: a touch begins and ends with the first and the last frame whose load
// is at least kLeastLoadN. If no frame has so much, as when the samples miss a
// short train of bounces or a stiff object keeps the arm off a soft one, it has
// one frame, the first after the touch of the first object. An object is moved
// (kWorldMovedM) as it is at the end of its touch. INVALID_CONFIG for bad
// options, NUMERICAL_FAILURE as SimulateContact and PressTogether.
absl::StatusOr<Trial> SceneTrial(const SkinModel& skin,
                                 const SceneOptions& options, uint64_t seed,
                                 uint64_t number);

// The touches of that trial one by one: each trial has one of them, of the same
// object at the same place and distance, as if the others were not there. Trial
// i of the result has the id number x (touches or objects) + i.
absl::StatusOr<std::vector<Trial>> SceneTrialsAlone(const SkinModel& skin,
                                                    const SceneOptions& options,
                                                    uint64_t seed,
                                                    uint64_t number);

}  // namespace tactus::internal
