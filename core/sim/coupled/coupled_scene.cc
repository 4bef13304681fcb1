#include "core/sim/coupled/coupled_scene.h"

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::internal {

CoupledObject ObjectOf(const ContactScene& scene) {
  return {.mass_kg = scene.object_mass_kg,
          .stiffness = scene.object_stiffness,
          .mu_static = scene.mu_static,
          .mu_kinetic = scene.mu_kinetic,
          .fixed = scene.fixed};
}

absl::Status Validate(const CoupledScene& scene) {
  const size_t count = scene.objects.size();
  if (count < 1 || count > limits::kMaxSceneObjects) {
    return InvalidScene("scene.objects", static_cast<double>(count),
                        absl::StrCat("1 to ", limits::kMaxSceneObjects));
  }
  for (const CoupledObject& object : scene.objects) {
    ContactScene alone = scene.arm;
    alone.object_mass_kg = object.mass_kg;
    alone.object_stiffness = object.stiffness;
    alone.mu_static = object.mu_static;
    alone.mu_kinetic = object.mu_kinetic;
    TACTUS_RETURN_IF_ERROR(Validate(alone));
    // Written so that a NaN fails.
    if (!(object.distance_m >= 0 && object.distance_m <= 10)) {
      return InvalidScene("scene.distance_m", object.distance_m, "0 to 10");
    }
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal
