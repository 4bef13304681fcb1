#include "tools/trainctl/data/simulate_jobs.h"

#include <span>
#include <utility>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/files/file_bytes.h"
#include "core/sim/exact/simulate_contact.h"
#include "core/sim/experiments/cody_set.h"
#include "core/sim/experiments/grid_set.h"
#include "core/sim/experiments/paper_set.h"
#include "core/sim/experiments/random_world.h"
#include "core/sim/skin/record_contact.h"
#include "core/sim/skin/skin_model.h"
#include "tools/trainctl/exit_code.h"

namespace tactus::internal::client {
namespace {

// The protocol's grid, with the values of the command line where there are any.
RobotGrid WithFlags(RobotGrid grid, const SimulateFlags& flags) {
  if (!flags.stiffnesses.empty()) grid.stiffnesses = flags.stiffnesses;
  if (!flags.velocities.empty()) grid.velocities = flags.velocities;
  if (!flags.goals.empty()) grid.goals = flags.goals;
  return grid;
}

absl::StatusOr<std::vector<Material>> ReadMaterials(const std::string& path) {
  if (path.empty()) return std::vector(Materials().begin(), Materials().end());
  TACTUS_ASSIGN_OR_RETURN(const std::string text,
                          ReadFileBytes(path, limits::kMaxCsvBytes));
  auto materials = ParseMaterials(text);
  if (!materials.ok()) return Annotate(materials.status(), path);
  return materials;
}

// Contacts of the same place and noise come from the same seed and number.
constexpr uint64_t kSkinStream = uint64_t{1} << 34;

// The noise of ideal signals, once `flags` are checked.
SignalNoise NoiseOf(const SimulateFlags& flags) {
  SignalNoise noise;
  if (!flags.noise.empty()) noise.reading = *ParseNoiseReading(flags.noise);
  return noise;
}

using SimulateJob = std::function<absl::StatusOr<std::vector<SensedContact>>()>;

SimulateJobs JobsOf(std::vector<SimulateJob> jobs) {
  const size_t count = jobs.size();
  return {count, [jobs = std::move(jobs)](size_t i) { return jobs[i](); }};
}

absl::StatusOr<SensedContact> Sense(const SimulatedContact& contact,
                                    const SimulateFlags& flags,
                                    const SkinLayout& layout) {
  SensedContact sensed;
  sensed.clamped = contact.signals.clamped > 0;
  if (!flags.skin.empty()) {
    TACTUS_ASSIGN_OR_RETURN(const SkinModel skin, SkinModelNamed(flags.skin));
    Random random =
        Random::ForStream(flags.seed, kSkinStream + contact.spec.number);
    const Placement placement = DrawPlacement(layout, random);
    sensed.trial = RecordContact(contact, skin, placement, random);
  } else {
    sensed.trial = SignalTrial(contact, NoiseOf(flags), flags.seed);
  }
  return sensed;
}

// Simulates a contact and, if its object moved, its twin with a fixed object.
// With `name_goal` the condition contains the goal.
SimulateJob PairJob(const TrialSpec& spec, bool name_goal,
                    const SimulateFlags& flags, const SkinLayout& layout) {
  return [&flags, &layout, spec,
          name_goal]() -> absl::StatusOr<std::vector<SensedContact>> {
    std::vector<SensedContact> sensed;
    TACTUS_ASSIGN_OR_RETURN(const auto contacts, SimulateWithTwin(spec));
    for (const SimulatedContact& contact : contacts) {
      TACTUS_ASSIGN_OR_RETURN(SensedContact one, Sense(contact, flags, layout));
      if (name_goal) one.trial.condition = ConditionName(spec.robot);
      sensed.push_back(std::move(one));
    }
    return sensed;
  };
}

SimulateJob CodyJob(const CodySpec& spec, const SimulateFlags& flags) {
  return [&flags, spec]() -> absl::StatusOr<std::vector<SensedContact>> {
    TACTUS_ASSIGN_OR_RETURN(const SimulatedContact contact,
                            SimulateContact(spec.contact));
    SensedContact sensed;
    sensed.clamped = contact.signals.clamped > 0;
    if (!flags.skin.empty()) {
      TACTUS_ASSIGN_OR_RETURN(const SkinModel skin, SkinModelNamed(flags.skin));
      TACTUS_ASSIGN_OR_RETURN(sensed.trial,
                              CodySkinTrial(spec, contact, skin, flags.seed));
    } else {
      TACTUS_ASSIGN_OR_RETURN(
          sensed.trial,
          CodySignalTrial(spec, contact, NoiseOf(flags), flags.seed));
    }
    return std::vector<SensedContact>{std::move(sensed)};
  };
}

SimulateJobs PaperJobs(const SimulateFlags& flags, const SkinLayout& layout,
                       std::span<const Material> materials) {
  const RobotGrid grid = WithFlags(PaperGrid(), flags);
  std::vector<SimulateJob> jobs;
  for (const TrialSpec& spec : TrialSpecs(grid.Conditions(), materials)) {
    jobs.push_back(PairJob(spec, grid.goals.size() > 1, flags, layout));
  }
  return JobsOf(std::move(jobs));
}

SimulateJobs GridJobs(const SimulateFlags& flags, const SkinLayout& layout,
                      std::span<const Material> materials) {
  const RobotGrid grid = WithFlags(UntrainedGrid(), flags);
  std::vector<SimulateJob> jobs;
  for (const TrialSpec& spec :
       DrawSpecs(grid.Conditions(), flags.seed, materials)) {
    jobs.push_back(PairJob(spec, /*name_goal=*/true, flags, layout));
  }
  return JobsOf(std::move(jobs));
}

absl::StatusOr<SimulateJobs> CodyJobs(const SimulateFlags& flags,
                                      const SkinLayout& layout) {
  if (!flags.stiffnesses.empty() || !flags.velocities.empty() ||
      !flags.goals.empty() || !flags.materials.empty()) {
    return InvalidConfig("--protocol with other conditions or materials",
                         "cody", "paper or grid");
  }
  std::vector<SimulateJob> jobs;
  for (const CodySpec& spec : CodySpecs(layout, flags.seed)) {
    jobs.push_back(CodyJob(spec, flags));
  }
  return JobsOf(std::move(jobs));
}

bool HasSeveral(const SceneOptions& scene) {
  return scene.touches > 1 || scene.objects > 1;
}

absl::StatusOr<SimulateJobs> WorldJobs(const SimulateFlags& flags) {
  if (!flags.stiffnesses.empty() || !flags.velocities.empty() ||
      !flags.goals.empty() || !flags.materials.empty()) {
    return InvalidConfig("--protocol with other conditions or materials",
                         "random", "paper or grid");
  }
  if (flags.contacts < 1) {
    return InvalidConfig("--contacts", flags.contacts, "at least 1");
  }
  if (const absl::Status status = Validate(flags.scene); !status.ok()) {
    return WithExitCode(status, kExitUsage);
  }
  if (flags.alone && !HasSeveral(flags.scene)) {
    return InvalidConfig("--alone", "given",
                         "with --touches or --objects: one contact is alone");
  }
  TACTUS_ASSIGN_OR_RETURN(const SkinModel skin, SkinModelNamed(flags.skin));
  if (flags.alone) {
    return SimulateJobs{
        static_cast<size_t>(flags.contacts),
        [skin, scene = flags.scene, seed = flags.seed](
            size_t i) -> absl::StatusOr<std::vector<SensedContact>> {
          TACTUS_ASSIGN_OR_RETURN(std::vector<Trial> trials,
                                  SceneTrialsAlone(skin, scene, seed, i));
          std::vector<SensedContact> sensed;
          for (Trial& trial : trials) {
            sensed.push_back({.trial = std::move(trial), .clamped = false});
          }
          return sensed;
        }};
  }
  return SimulateJobs{
      static_cast<size_t>(flags.contacts),
      [skin, scene = flags.scene, seed = flags.seed](
          size_t i) -> absl::StatusOr<std::vector<SensedContact>> {
        SensedContact sensed;
        TACTUS_ASSIGN_OR_RETURN(
            sensed.trial, HasSeveral(scene) ? SceneTrial(skin, scene, seed, i)
                                            : WorldTrial(skin, seed, i));
        return std::vector<SensedContact>{std::move(sensed)};
      }};
}

}  // namespace

absl::StatusOr<SkinLayout> LayoutOf(const SimulateFlags& flags) {
  if (flags.skin.empty()) return LayoutPreset("cody-forearm");
  const auto skin = SkinModelNamed(flags.skin);
  if (!skin.ok()) return WithExitCode(skin.status(), kExitUsage);
  return skin->layout;
}

std::string NoiseOrDefault(const std::string& noise) {
  return noise.empty() ? "relative" : noise;
}

absl::StatusOr<SimulateJobs> MakeJobs(const SimulateFlags& flags,
                                      const SkinLayout& layout) {
  if (!flags.noise.empty()) {
    const auto noise = ParseNoiseReading(flags.noise);
    if (!noise.ok()) return WithExitCode(noise.status(), kExitUsage);
    if (!flags.skin.empty()) {
      return InvalidConfig("--noise with a skin", flags.noise,
                           "absent: a skin's noise is absolute");
    }
  }
  if (flags.sample < 1) {
    return InvalidConfig("--sample", flags.sample, "at least 1");
  }
  if (flags.protocol == "random") return WorldJobs(flags);
  if (HasSeveral(flags.scene)) {
    return InvalidConfig("--protocol with --touches or --objects",
                         flags.protocol, "random");
  }
  if (flags.protocol == "cody") return CodyJobs(flags, layout);
  TACTUS_ASSIGN_OR_RETURN(const std::vector<Material> materials,
                          ReadMaterials(flags.materials));
  if (flags.protocol == "paper") return PaperJobs(flags, layout, materials);
  if (flags.protocol == "grid") return GridJobs(flags, layout, materials);
  return InvalidConfig("--protocol", flags.protocol,
                       "paper, grid, cody or random");
}

}  // namespace tactus::internal::client
