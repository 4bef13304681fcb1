#include "core/sim/coupled/press_together.h"

#include <algorithm>
#include <cmath>

#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/sim/coupled/coupled.h"
#include "core/sim/skin/block_filter.h"

namespace tactus::internal {
namespace {

absl::StatusOr<CoupledScene> SceneOf(std::span<const PressedObject> objects) {
  if (objects.empty()) return InvalidScene("scene.objects", 0.0, "at least 1");
  CoupledScene scene;
  scene.arm = SceneOf(objects.front().spec);
  for (const PressedObject& pressed : objects) {
    CoupledObject object = ObjectOf(SceneOf(pressed.spec));
    object.distance_m = pressed.distance_m;
    const double compliance =
        1 / scene.arm.arm_mass_kg + (object.fixed ? 0 : 1 / object.mass_kg);
    object.stiffness = std::min(object.stiffness,
                                kMaxRingingRadS * kMaxRingingRadS / compliance);
    scene.objects.push_back(object);
  }
  return scene;
}

IdealSignals ReadSignals(const Trajectory& run) {
  const BlockFilter& filter = BlockFilter::AntiAlias();
  BlockFilter::Column force = {};
  BlockFilter::Column motion = {};
  IdealSignals signals;
  const auto& raw = run.samples;
  for (size_t begin = 1; begin + kFilterBlock <= raw.size();
       begin += kFilterBlock) {
    BlockFilter::Inputs forces;
    BlockFilter::Inputs motions;
    for (int j = 0; j < kFilterBlock; ++j) {
      const TrajectorySample& sample = raw[begin + j];
      forces[j] = (sample.impulse - raw[begin + j - 1].impulse) * kSignalRateHz;
      motions[j] = sample.x_arm;
    }
    force = filter.Step(force, forces);
    motion = filter.Step(motion, motions);
    signals.samples.push_back(
        {BlockFilter::Output(force), 0, BlockFilter::Output(motion)});
    signals.object_motion.push_back(raw[begin + kFilterBlock - 1].x_uobj);
  }
  return signals;
}

}  // namespace

absl::StatusOr<std::vector<SimulatedContact>> PressTogether(
    std::span<const PressedObject> objects) {
  TACTUS_ASSIGN_OR_RETURN(const CoupledScene scene, SceneOf(objects));
  TACTUS_ASSIGN_OR_RETURN(
      const std::vector<Trajectory> runs,
      IntegrateCoupled(scene, {.sample_rate_hz = kSignalRateHz}));
  std::vector<SimulatedContact> contacts;
  for (size_t i = 0; i < objects.size(); ++i) {
    contacts.push_back({.spec = objects[i].spec,
                        .signals = ReadSignals(runs[i]),
                        .moved = runs[i].moved,
                        .events = runs[i].events});
  }
  return contacts;
}

absl::StatusOr<double> ArmAfter(double seconds,
                                std::span<const PressedObject> objects) {
  TACTUS_ASSIGN_OR_RETURN(CoupledScene scene, SceneOf(objects));
  scene.arm.duration_s = std::max(std::round(seconds * 1000) / 1000, 0.01);
  TACTUS_ASSIGN_OR_RETURN(const std::vector<Trajectory> runs,
                          IntegrateCoupled(scene, {.sample_rate_hz = 1000}));
  return runs.front().samples.back().x_arm;
}

}  // namespace tactus::internal
