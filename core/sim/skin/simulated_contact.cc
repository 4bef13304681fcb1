#include "core/sim/skin/simulated_contact.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/random.h"
#include "core/sim/skin/block_filter.h"

namespace tactus::internal {

std::string SimulatedContact::Label() const {
  return absl::StrCat(hard() ? "H" : "S", moved ? "M" : "U");
}

Trial SimulatedContact::Metadata() const {
  Trial trial;
  trial.id = absl::StrFormat("%06d", spec.number);
  trial.label = Label();
  trial.condition =
      absl::StrCat("k", spec.robot.stiffness, "-v", spec.robot.velocity);
  trial.object = absl::StrFormat(
      "%s-%.4f-%s%s", spec.object.material.name, spec.object.edge_m,
      SurfaceName(spec.object.surface), spec.fixed ? "-fixed" : "");
  trial.material = std::string(spec.object.material.name);
  trial.stiffness = spec.object.Stiffness();
  trial.velocity = spec.robot.velocity;
  trial.sample_rate_hz = kSkinRateHz;
  trial.unit = "newton";
  return trial;
}

Trial SignalTrial(const SimulatedContact& contact, const SignalNoise& noise,
                  uint64_t seed) {
  Trial trial = contact.Metadata();
  trial.signals = contact.signals.samples;
  trial.object_motion = contact.signals.object_motion;
  trial.time.reserve(trial.signals.size());
  for (size_t i = 0; i < trial.signals.size(); ++i) {
    trial.time.push_back(i / kSkinRateHz);
  }
  Random random = Random::ForStream(seed, contact.spec.number);
  AddNoise(noise, random, trial.signals);
  return trial;
}

}  // namespace tactus::internal
