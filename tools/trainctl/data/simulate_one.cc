#include "tools/trainctl/data/simulate_one.h"

#include <cmath>
#include <map>

#include "absl/strings/str_format.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/files/file_bytes.h"
#include "core/sim/exact/exact.h"
#include "tools/trainctl/command.h"

namespace tactus::internal::client {
namespace {

constexpr char kKeys[] =
    "m_arm, k_act, b_act, v, goal, m_obj, k_obj, mu_s, mu_k, fixed, duration, "
    "retreat_after or retreat_speed";

}  // namespace

void AddOneContactFlags(CLI::App& command, OneContactFlags& flags) {
  CLI::Option* one = command.add_option(
      "--one", flags.scene,
      "Simulate one contact: a scene in JSON, or @ and a file that holds it");
  command.add_option("--rate", flags.rate_hz, "Of --one: samples a second")
      ->needs(one);
  command.add_flag("--csv", flags.csv, "Of --one: print CSV")->needs(one);
}

absl::StatusOr<ContactScene> ParseScene(absl::string_view json) {
  const Json object = Json::parse(json.begin(), json.end(), nullptr,
                                  /*allow_exceptions=*/false);
  if (!object.is_object()) {
    return InvalidScene("--one", json.substr(0, limits::kMaxNameBytes),
                        "an object in JSON");
  }
  ContactScene scene;
  // Stays so if b_act is absent.
  scene.actuator_damping = std::nan("");
  const std::map<std::string, double*> numbers = {
      {"m_arm", &scene.arm_mass_kg},
      {"k_act", &scene.actuator_stiffness},
      {"b_act", &scene.actuator_damping},
      {"v", &scene.velocity_m_s},
      {"goal", &scene.goal_m},
      {"m_obj", &scene.object_mass_kg},
      {"k_obj", &scene.object_stiffness},
      {"mu_s", &scene.mu_static},
      {"mu_k", &scene.mu_kinetic},
      {"duration", &scene.duration_s},
      {"retreat_after", &scene.retreat_after_s},
      {"retreat_speed", &scene.retreat_speed_m_s},
  };
  for (const auto& [key, value] : object.items()) {
    if (key == "fixed") {
      if (!value.is_boolean()) {
        return InvalidScene(key, JsonText(value), "true or false");
      }
      scene.fixed = value.get<bool>();
      continue;
    }
    const auto found = numbers.find(key);
    if (found == numbers.end()) {
      return InvalidScene("key", key, kKeys);
    }
    if (!value.is_number()) {
      return InvalidScene(key, JsonText(value), "a number");
    }
    *found->second = value.get<double>();
  }
  if (!object.contains("b_act")) {
    scene.actuator_damping =
        CriticalDamping(scene.actuator_stiffness, scene.arm_mass_kg);
  }
  TACTUS_RETURN_IF_ERROR(Validate(scene));
  return scene;
}

absl::Status SimulateOne(const OneContactFlags& flags, std::ostream& out) {
  if (!flags.csv) return InvalidConfig("--one", "given", "given with --csv");
  std::string json = flags.scene;
  if (json[0] == '@') {
    TACTUS_ASSIGN_OR_RETURN(
        json, ReadFileBytes(json.substr(1), limits::kMaxMessageBytes));
  }
  TACTUS_ASSIGN_OR_RETURN(const ContactScene scene, ParseScene(json));
  ExactOptions options;
  options.sample_rate_hz = flags.rate_hz;
  TACTUS_ASSIGN_OR_RETURN(const Trajectory run, IntegrateExact(scene, options));
  out << "t,x_arm,v_arm,x_uobj,v_uobj,F_surf\n";
  for (size_t i = 0; i < run.samples.size(); ++i) {
    const TrajectorySample& sample = run.samples[i];
    // All digits, so that the text holds the numbers themselves.
    out << absl::StrFormat("%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n",
                           static_cast<double>(i) / run.sample_rate_hz,
                           sample.x_arm, sample.v_arm, sample.x_uobj,
                           sample.v_uobj, sample.force);
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal::client
