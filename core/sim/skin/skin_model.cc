#include "core/sim/skin/skin_model.h"

#include <utility>

#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus {
namespace {

void SetThresholds(double contact, double onset, SkinModel& skin) {
  skin.layout.contact_threshold = contact;
  skin.layout.onset_threshold = onset;
}

}  // namespace

absl::StatusOr<SkinModel> SkinModelNamed(absl::string_view name) {
  SkinModel skin;
  skin.name = std::string(name);
  TACTUS_ASSIGN_OR_RETURN(skin.layout, LayoutPreset("cody-forearm"));
  if (name == "paper") {
    skin.noise_n = 1e-6;
    skin.pose_noise_min_m = skin.pose_noise_max_m = 1e-6;
    skin.pose_gain_error_max = 0;
    // Seven standard deviations: one frame in 10^9 has a taxel above it.
    SetThresholds(7e-6, 7e-6, skin);
    return skin;
  }
  if (name == "good") {
    skin.noise_n = 0.002;
    skin.step_n = 0.001;
    return skin;
  }
  if (name == "measured") {
    skin.noise_n = 0.004;
    skin.step_n = 0.002;
    skin.drift_n = 0.002;
    skin.lagging = 0.15;
    skin.lag_s = 0.4;
    skin.dead_taxels = 4;
    skin.stray_taxels = 4;
    skin.stray_min_n = 0.024;
    skin.stray_max_n = 0.097;
    SetThresholds(0.12, 0.15, skin);
    return skin;
  }
  return InvalidConfig("skin", name, "paper, good or measured");
}

}  // namespace tactus
