#include "core/sim/skin/skin_model.h"

#include <utility>

#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

void SetThresholds(double contact, double onset, SkinModel& skin) {
  skin.layout.contact_threshold = contact;
  skin.layout.onset_threshold = onset;
}

// Regions of 3 x 3 taxels over 0.1 s. `deviation`, N, and the factors are those
// of LightNoise, from idle recordings of ten minutes.
void SetLightTouch(double deviation, SkinModel& skin) {
  skin.layout.light_touch = {.window_s = 0.1,
                             .rows = 3,
                             .columns = 3,
                             .contact_threshold = 5 * deviation,
                             .onset_threshold = 7 * deviation};
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
    SetLightTouch(8e-5, skin);
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
    // Five and seven standard deviations of a reading above its background.
    SetThresholds(0.02, 0.03, skin);
    SetLightTouch(4.4e-4, skin);
    return skin;
  }
  return InvalidConfig("skin", name, "paper, good or measured");
}

}  // namespace tactus::internal
