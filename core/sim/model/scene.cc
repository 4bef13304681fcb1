#include "core/sim/model/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

absl::Status CheckRange(absl::string_view field, double value, double low,
                        double high) {
  if (value >= low && value <= high) return absl::OkStatus();
  return InvalidScene(field, value, absl::StrCat(low, " to ", high));
}

}  // namespace

double CriticalDamping(double actuator_stiffness, double arm_mass_kg) {
  return 2 * std::sqrt(actuator_stiffness * arm_mass_kg);
}

void SetApproach(double seconds, ContactScene& scene) {
  // e = v t exp(-w t) solves e'' + 2 w e' + w^2 e = 0 with e = 0 and e' = v at
  // rest, where e is the lead of the equilibrium point.
  const double w = std::sqrt(scene.actuator_stiffness / scene.arm_mass_kg);
  const double fade = std::exp(-w * seconds);
  scene.lead_m = scene.velocity_m_s * seconds * fade;
  scene.touch_speed_m_s = scene.velocity_m_s * (1 - fade * (1 - w * seconds));
}

double ApproachPosition(double approach_s, double before_s,
                        const ContactScene& scene) {
  // v t - e of SetApproach is how far the arm has come after t seconds.
  const double w = std::sqrt(scene.actuator_stiffness / scene.arm_mass_kg);
  const auto way = [&](double t) {
    return -scene.velocity_m_s * t * std::expm1(-w * t);
  };
  return way(std::max(approach_s - before_s, 0.0)) - way(approach_s);
}

absl::Status Validate(const ContactScene& scene) {
  using limits::kMaxSceneDurationS;
  TACTUS_RETURN_IF_ERROR(
      CheckRange("scene.arm_mass_kg", scene.arm_mass_kg, 1e-3, 1e3));
  TACTUS_RETURN_IF_ERROR(
      CheckRange("scene.actuator_stiffness", scene.actuator_stiffness, 1, 1e6));
  TACTUS_RETURN_IF_ERROR(
      CheckRange("scene.actuator_damping", scene.actuator_damping, 0, 1e6));
  TACTUS_RETURN_IF_ERROR(
      CheckRange("scene.velocity_m_s", scene.velocity_m_s, 1e-5, 10));
  TACTUS_RETURN_IF_ERROR(CheckRange("scene.goal_m", scene.goal_m, 1e-6, 10));
  TACTUS_RETURN_IF_ERROR(
      CheckRange("scene.touch_speed_m_s", scene.touch_speed_m_s, 0, 10));
  TACTUS_RETURN_IF_ERROR(
      CheckRange("scene.lead_m", scene.lead_m, 0, scene.goal_m));
  // Written so that a NaN fails; infinity is no retreat.
  if (!(scene.retreat_after_s >= 0)) {
    return InvalidScene("scene.retreat_after_s", scene.retreat_after_s,
                        "at least 0, or infinite");
  }
  if (scene.retreat_after_s < std::numeric_limits<double>::infinity()) {
    TACTUS_RETURN_IF_ERROR(CheckRange("scene.retreat_speed_m_s",
                                      scene.retreat_speed_m_s, 1e-5, 10));
  }
  TACTUS_RETURN_IF_ERROR(
      CheckRange("scene.object_mass_kg", scene.object_mass_kg, 1e-6, 1e6));
  TACTUS_RETURN_IF_ERROR(
      CheckRange("scene.object_stiffness", scene.object_stiffness, 1, 1e15));
  TACTUS_RETURN_IF_ERROR(
      CheckRange("scene.mu_static", scene.mu_static, 1e-3, 10));
  TACTUS_RETURN_IF_ERROR(
      CheckRange("scene.mu_kinetic", scene.mu_kinetic, 1e-3, scene.mu_static));
  return CheckRange("scene.duration_s", scene.duration_s, 0.01,
                    kMaxSceneDurationS);
}

}  // namespace tactus::internal
