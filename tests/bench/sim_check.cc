#include "tests/bench/sim_check.h"

#include <cmath>
#include <cstdio>

#include "absl/strings/str_format.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/sim/skin/block_filter.h"
#include "tests/bench/timing.h"
#include "tests/reference/sim/long_double.h"
#include "tests/reference/sim/read_signals.h"

namespace tactus::internal::client {
namespace {

constexpr std::array<double, 2> kBounds = {1e-6, 1e-3};
// Step of the reference when a scene is compared again.
constexpr double kFineStepShare = 0.002;

std::string Describe(const SimulatedContact& contact) {
  const ContactScene scene = SceneOf(contact.spec);
  return absl::StrFormat(
      "%s of %.3g kg and %.3g N/m, friction %.3g and %.3g, at %g N/m, %g m/s "
      "to %g m: %d events",
      contact.Metadata().object, scene.object_mass_kg, scene.object_stiffness,
      scene.mu_static, scene.mu_kinetic, scene.actuator_stiffness,
      scene.velocity_m_s, scene.goal_m, contact.events.Total());
}

}  // namespace

SolverOptions CvodeAt(double tolerance) {
  SolverOptions options;
  const double scale = tolerance / options.relative_tolerance;
  options.relative_tolerance = tolerance;
  options.force_tolerance *= scale;
  options.velocity_tolerance *= scale;
  options.position_tolerance *= scale;
  options.max_steps = 1'000'000'000;
  // Order 2 cannot damp the ringing at these tolerances and would resolve it
  // slowly.
  if (tolerance < 1e-5) options.ringing_order = 5;
  return options;
}

SimulateOptions ExactAt(double skip_tolerance) {
  SimulateOptions options;
  options.exact.skip_tolerance = skip_tolerance;
  return options;
}

double FeatureError(const std::vector<FeatureVector>& got,
                    const std::vector<FeatureVector>& want) {
  double worst = 0;
  for (int f = 0; f < kFeatureCount; ++f) {
    double peak = 0;
    double error = 0;
    for (size_t i = 0; i < want.size(); ++i) {
      peak = std::max(peak, std::abs(want[i][f]));
      error = std::max(error, std::abs(got[i][f] - want[i][f]));
    }
    if (peak > 0) worst = std::max(worst, error / peak);
  }
  return worst;
}

absl::StatusOr<std::vector<FeatureVector>> ReferenceFeatures(
    const TrialSpec& spec, double step_share) {
  TACTUS_ASSIGN_OR_RETURN(
      const Trajectory run,
      IntegrateReference(SceneOf(spec), kSignalRateHz, step_share));
  return ReadSignals(spec.object, run).samples;
}

TrialSpec RandomSpec(Random& random) {
  TrialSpec spec;
  while (true) {
    const auto log_uniform = [&](double low, double high) {
      return low * std::exp(random.Uniform() * std::log(high / low));
    };
    Material material;
    material.name = "random";
    material.youngs_modulus = log_uniform(1e3, 2e11);
    material.density = log_uniform(10, 1e4);
    material.poisson_ratio = random.Uniform(0, 0.5);
    material.wood.mu_static = random.Uniform(0.11, 0.95);
    material.wood.mu_kinetic = material.wood.mu_static * random.Uniform(0.3, 1);
    spec.object = {material, log_uniform(0.005, 0.3), Surface::kWood};
    spec.robot = {log_uniform(50, 5000), log_uniform(0.002, 0.1),
                  log_uniform(0.002, 0.05)};
    spec.fixed = random.Index(4) == 0;
    const double rate = std::sqrt(spec.object.Stiffness() / spec.object.Mass());
    if (rate < 2e4) return spec;
  }
}

void WorstErrors::Take(const SimulatedContact& contact,
                       const std::vector<FeatureVector>& truth) {
  ++compared_;
  const bool skipped = contact.skipped_bounces > 0;
  ++count_[skipped];
  const double error = FeatureError(contact.signals.samples, truth);
  if (error > error_[skipped] || where_[skipped].empty()) {
    error_[skipped] = error;
    where_[skipped] = Describe(contact);
  }
}

void WorstErrors::Print(const char* what) const {
  std::fprintf(stderr, "%s: %d compared\n", what, compared_);
  for (int skipped = 0; skipped < 2; ++skipped) {
    if (count_[skipped] == 0) continue;
    std::fprintf(stderr, "  %d %s skipped bounces, worst error %.2g: %s\n",
                 count_[skipped], skipped ? "with" : "without", error_[skipped],
                 where_[skipped].c_str());
  }
}

absl::Status WorstErrors::Check() const {
  for (int skipped = 0; skipped < 2; ++skipped) {
    if (error_[skipped] <= kBounds[skipped]) continue;
    return NumericalFailure(absl::StrFormat(
        "the exact method has an error of %.2g, above %g, for %s",
        error_[skipped], kBounds[skipped], where_[skipped]));
  }
  return absl::OkStatus();
}

absl::StatusOr<SceneComparison> CompareScenes(
    const char* what, int count, double budget,
    absl::FunctionRef<TrialSpec(int)> spec_of) {
  SceneComparison comparison;
  const double deadline = ThreadSeconds() + budget;
  for (int i = 0; i < count; ++i) {
    if (ThreadSeconds() > deadline) {
      std::fprintf(stderr,
                   "%s: %d of %d left out because the time is used up\n", what,
                   count - i, count);
      break;
    }
    const TrialSpec spec = spec_of(i);
    const double start = ThreadSeconds();
    TACTUS_ASSIGN_OR_RETURN(const SimulatedContact contact,
                            SimulateContact(spec));
    comparison.seconds += ThreadSeconds() - start;
    TACTUS_ASSIGN_OR_RETURN(auto truth, ReferenceFeatures(spec));
    if (contact.skipped_bounces == 0 &&
        FeatureError(contact.signals.samples, truth) > kBounds[0]) {
      // The reference may have stepped over a short loss of contact, in which
      // the area is zero.
      TACTUS_ASSIGN_OR_RETURN(truth, ReferenceFeatures(spec, kFineStepShare));
    }
    comparison.worst.Take(contact, truth);
  }
  comparison.worst.Print(what);
  TACTUS_RETURN_IF_ERROR(comparison.worst.Check());
  return comparison;
}

}  // namespace tactus::internal::client
