#include "core/sim/experiments/paper_set.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/random.h"
#include "core/base/status_macros.h"
#include "core/sim/exact/piece_signals.h"

namespace tactus {
namespace {

constexpr int kEdges = 10;
constexpr double kSmallestEdge = 0.01;  // m
constexpr double kLargestEdge = 0.2;

}  // namespace

std::vector<RobotCondition> PaperConditions(double goal_m) {
  std::vector<RobotCondition> conditions;
  for (double stiffness : {543.0, 2050.0}) {
    for (double velocity : {0.005, 0.02}) {
      conditions.push_back({stiffness, velocity, goal_m});
    }
  }
  return conditions;
}

std::vector<TrialSpec> TrialSpecs(const std::vector<RobotCondition>& robots,
                                  std::span<const Material> materials) {
  std::vector<TrialSpec> specs;
  for (const RobotCondition& robot : robots) {
    for (const Material& material : materials) {
      for (int i = 0; i < kEdges; ++i) {
        const double edge =
            kSmallestEdge + i * (kLargestEdge - kSmallestEdge) / (kEdges - 1);
        for (Surface surface : {Surface::kWood, Surface::kGlass}) {
          TrialSpec spec;
          spec.object = {material, edge, surface};
          spec.robot = robot;
          spec.number = 2 * specs.size();
          specs.push_back(spec);
        }
      }
    }
  }
  return specs;
}

ContactScene SceneOf(const TrialSpec& spec) {
  ContactScene scene;
  scene.actuator_stiffness = spec.robot.stiffness;
  scene.actuator_damping =
      CriticalDamping(spec.robot.stiffness, scene.arm_mass_kg);
  scene.velocity_m_s = spec.robot.velocity;
  scene.goal_m = spec.robot.goal_m;
  scene.object_mass_kg = spec.object.Mass();
  scene.object_stiffness = spec.object.Stiffness();
  const Friction friction = spec.object.TableFriction();
  scene.mu_static = friction.mu_static;
  scene.mu_kinetic = friction.mu_kinetic;
  scene.fixed = spec.fixed;
  return scene;
}

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

TrialSpec FixedTwin(const TrialSpec& spec) {
  TrialSpec twin = spec;
  twin.fixed = true;
  twin.number = spec.number + 1;
  return twin;
}

absl::StatusOr<SimulatedContact> SimulateContact(
    const TrialSpec& spec, const SimulateOptions& options) {
  const ContactScene scene = SceneOf(spec);
  SimulatedContact contact;
  contact.spec = spec;
  if (options.method == SimMethod::kCvode) {
    TACTUS_ASSIGN_OR_RETURN(const Trajectory trajectory,
                            IntegrateCvode(scene, options.cvode));
    contact.signals = ReadSignals(spec.object, trajectory, options.area);
    contact.moved = trajectory.moved;
    contact.events = trajectory.events;
    contact.steps = trajectory.steps;
    return contact;
  }
  TACTUS_RETURN_IF_ERROR(Validate(scene));
  PieceSignals reader(spec.object, scene, options.area);
  TACTUS_ASSIGN_OR_RETURN(const PieceSummary summary,
                          SolvePieces(scene, options.exact, reader));
  contact.signals = reader.Finish();
  contact.moved = summary.moved;
  contact.events = summary.events;
  contact.skipped_bounces = summary.skipped;
  return contact;
}

absl::Status ForEachContact(
    std::span<const TrialSpec> specs, const SimulateOptions& options,
    absl::FunctionRef<absl::Status(const SimulatedContact&)> take) {
  for (const TrialSpec& spec : specs) {
    TACTUS_ASSIGN_OR_RETURN(const SimulatedContact contact,
                            SimulateContact(spec, options));
    TACTUS_RETURN_IF_ERROR(take(contact));
    if (!contact.moved) continue;
    TACTUS_ASSIGN_OR_RETURN(const SimulatedContact twin,
                            SimulateContact(FixedTwin(spec), options));
    TACTUS_RETURN_IF_ERROR(take(twin));
  }
  return absl::OkStatus();
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

}  // namespace tactus
