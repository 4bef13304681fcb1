#include "client/bench/sim.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/functional/function_ref.h"
#include "absl/strings/str_format.h"
#include "client/bench/work_precision.h"
#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/base/status_macros.h"
#include "core/sim/paper_set.h"
#include "core/sim/reference.h"

namespace tactus::client {
namespace {

struct SimBenchOptions {
  // A few trials and tolerances, for tests.
  bool quick = false;
  // Also compares every trial of the paper's set and this many random scenes
  // with the reference.
  bool all = false;
  int random_scenes = 10'000;
  // Stops comparing after so much processor time, s.
  double budget = 300;
};

struct SimReport {
  std::vector<BenchRow> rows;
  std::vector<WorkPoint> points;
};

// Bounds of the exact method, which the benchmark fails beyond: where every
// bounce was solved, and where some were leapt over.
constexpr double kSolvedBound = 1e-6;
constexpr double kSkippedBound = 1e-3;

constexpr char kReference[] =
    "long double matrix exponentials, every ringing period resolved";
// Of the base trials, every one of this many (and its fixed twin) is compared
// with CVODE.
constexpr size_t kStride = 37;
constexpr size_t kQuickStride = 131;
// Contacts with more events are not integrated with CVODE: at tight
// tolerances they would take minutes each.
constexpr int kSampleEvents = 20'000;

// Processor time of this thread, s.
double ThreadSeconds() {
  timespec time;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * time.tv_nsec;
}

// Largest error of any feature, as a share of its peak.
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

struct Case {
  TrialSpec spec;
  std::vector<FeatureVector> truth;
};

struct Work {
  double seconds = 0;
  std::vector<double> errors;

  double Worst() const {
    return *std::max_element(errors.begin(), errors.end());
  }
  double Median() const {
    std::vector<double> sorted = errors;
    std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2,
                     sorted.end());
    return sorted[sorted.size() / 2];
  }
};

absl::StatusOr<std::vector<FeatureVector>> Truth(const TrialSpec& spec) {
  TACTUS_ASSIGN_OR_RETURN(const Trajectory run,
                          IntegrateReference(SceneOf(spec), kSignalRateHz));
  return ReadSignals(spec.object, run).samples;
}

absl::StatusOr<Work> Measure(const std::vector<Case>& cases,
                             const SimulateOptions& options) {
  Work work;
  for (const Case& each : cases) {
    const double start = ThreadSeconds();
    TACTUS_ASSIGN_OR_RETURN(const SimulatedContact contact,
                            SimulateContact(each.spec, options));
    work.seconds += ThreadSeconds() - start;
    work.errors.push_back(FeatureError(contact.signals.samples, each.truth));
  }
  return work;
}

SimulateOptions Cvode(double tolerance) {
  SimulateOptions options;
  options.method = SimMethod::kCvode;
  // Relative and, in the default's proportion, absolute.
  const double share = tolerance / options.cvode.relative_tolerance;
  options.cvode.relative_tolerance = tolerance;
  options.cvode.force_tolerance *= share;
  options.cvode.velocity_tolerance *= share;
  options.cvode.position_tolerance *= share;
  options.cvode.max_steps = 1'000'000'000;
  return options;
}

// A scene far from the paper's that the reference can resolve.
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

SimulateOptions Exact(double skip_tolerance) {
  SimulateOptions options;
  options.exact.skip_tolerance = skip_tolerance;
  return options;
}

// Of a thread that compares scenes with the reference: the worst errors and
// where they were, apart for scenes with and without skipped bounces.
class Worst {
 public:
  absl::Status Take(const SimulatedContact& contact,
                    const std::vector<FeatureVector>& truth) {
    ++compared_;
    const bool skipped = contact.skipped_bounces > 0;
    const double error = FeatureError(contact.signals.samples, truth);
    const ContactScene scene = SceneOf(contact.spec);
    const std::string where = absl::StrFormat(
        "%s of %.3g kg and %.3g N/m, friction %.3g and %.3g, at %g N/m, %g m/s "
        "to %g m: %d events",
        contact.Metadata().object, scene.object_mass_kg, scene.object_stiffness,
        scene.mu_static, scene.mu_kinetic, scene.actuator_stiffness,
        scene.velocity_m_s, scene.goal_m, contact.events.Total());
    if (error > error_[skipped]) {
      error_[skipped] = error;
      where_[skipped] = where;
    }
    const double bound = skipped ? kSkippedBound : kSolvedBound;
    if (error <= bound) return absl::OkStatus();
    return NumericalFailure(
        absl::StrFormat("the exact method is off by %.2g, more than %g, for %s",
                        error, bound, where));
  }

  double error() const { return std::max(error_[0], error_[1]); }

  void Print(const char* what) const {
    std::fprintf(stderr, "%s: %d compared\n", what, compared_);
    for (int skipped = 0; skipped < 2; ++skipped) {
      if (where_[skipped].empty()) continue;
      std::fprintf(stderr, "  worst %s %.2g: %s\n",
                   skipped ? "with skipped bounces" : "of the others",
                   error_[skipped], where_[skipped].c_str());
    }
  }

 private:
  int compared_ = 0;
  std::array<double, 2> error_ = {};
  std::array<std::string, 2> where_;
};

// Compares `count` scenes with the reference, within `deadline` seconds of
// processor time.
absl::Status CompareAll(const char* what, int count, double deadline,
                        absl::FunctionRef<TrialSpec(int)> spec_of, Worst& worst,
                        double& seconds) {
  for (int i = 0; i < count; ++i) {
    if (ThreadSeconds() > deadline) {
      std::fprintf(stderr, "%s: out of time after %d of %d\n", what, i, count);
      break;
    }
    const TrialSpec spec = spec_of(i);
    const double start = ThreadSeconds();
    TACTUS_ASSIGN_OR_RETURN(const SimulatedContact contact,
                            SimulateContact(spec));
    seconds += ThreadSeconds() - start;
    TACTUS_ASSIGN_OR_RETURN(const auto truth, Truth(spec));
    TACTUS_RETURN_IF_ERROR(worst.Take(contact, truth));
    if (i % 100 == 99) {
      std::fprintf(stderr, "%s: %d of %d, worst error %.2g\n", what, i + 1,
                   count, worst.error());
    }
  }
  worst.Print(what);
  return absl::OkStatus();
}

absl::StatusOr<SimReport> MeasureSim(const SimBenchOptions& options) {
  SimReport report;

  // The whole set as it is used: filtered, with noise.
  std::vector<TrialSpec> trials;
  double whole = 0;
  {
    const double start = ThreadSeconds();
    TACTUS_RETURN_IF_ERROR(ForEachContact(
        TrialSpecs(PaperConditions()), {},
        [&](const SimulatedContact& contact) {
          const Trial trial = SignalTrial(contact, SignalNoise(), 1);
          trials.push_back(contact.spec);
          return trial.signals.empty() ? NumericalFailure("no signals")
                                       : absl::OkStatus();
        }));
    whole = ThreadSeconds() - start;
  }

  // The sample, and the truth of it.
  std::vector<Case> sample;
  Worst worst;
  const size_t stride = options.quick ? kQuickStride : kStride;
  for (size_t i = 0; i < trials.size(); i += stride) {
    TACTUS_ASSIGN_OR_RETURN(const SimulatedContact contact,
                            SimulateContact(trials[i]));
    if (contact.events.Total() > kSampleEvents) continue;
    TACTUS_ASSIGN_OR_RETURN(auto truth, Truth(contact.spec));
    TACTUS_RETURN_IF_ERROR(worst.Take(contact, truth));
    sample.push_back({contact.spec, std::move(truth)});
  }
  worst.Print("sample of the paper's set");

  std::vector<double> skips = {0, 1e-6, 1e-3, 1e-1};
  if (options.quick) skips = {0, 1e-3};
  WorkPoint exact;  // at the default
  for (double tolerance : skips) {
    TACTUS_ASSIGN_OR_RETURN(const Work work, Measure(sample, Exact(tolerance)));
    report.points.push_back(
        {"exact", tolerance, work.seconds, work.Median(), work.Worst()});
    if (tolerance == ExactOptions().skip_tolerance) {
      exact = report.points.back();
    }
  }
  std::vector<double> tolerances = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8};
  if (options.quick) tolerances = {1e-2, 1e-4};
  for (double tolerance : tolerances) {
    TACTUS_ASSIGN_OR_RETURN(const Work work, Measure(sample, Cvode(tolerance)));
    report.points.push_back(
        {"CVODE", tolerance, work.seconds, work.Median(), work.Worst()});
  }

  if (options.all) {
    double seconds = 0;
    TACTUS_RETURN_IF_ERROR(CompareAll(
        "paper's set", trials.size(), ThreadSeconds() + options.budget / 2,
        // Mixed, so that what the time allows is a fair sample.
        [&](int i) { return trials[i * 997 % trials.size()]; }, worst,
        seconds));
    Random random(1);
    Worst worst_random;
    seconds = 0;
    TACTUS_RETURN_IF_ERROR(CompareAll(
        "random scenes", options.random_scenes,
        ThreadSeconds() + options.budget / 2,
        [&](int) { return RandomSpec(random); }, worst_random, seconds));
    report.rows.push_back({.name = "sim/random-scenes",
                           .unit = "s",
                           .ours = seconds,
                           .error = worst_random.error(),
                           .error_reference = kReference});
  }
  report.rows.insert(report.rows.begin(), {.name = "sim/paper-set",
                                           .unit = "s",
                                           .ours = whole,
                                           .error = worst.error(),
                                           .error_reference = kReference});
  for (const WorkPoint& point : report.points) {
    BenchRow row = {
        .name = absl::StrFormat("sim/%s-%g", point.method, point.tolerance),
        .unit = "s",
        .ours = point.seconds,
        .error = point.worst_error,
        .error_reference = kReference};
    if (point.method == "CVODE") {
      row.ours = exact.seconds;
      row.peer = point.seconds;
      row.peer_name =
          absl::StrFormat("CVODE at relative tolerance %g, error %.2g",
                          point.tolerance, point.worst_error);
      row.error = exact.worst_error;
    }
    report.rows.push_back(row);
  }
  return report;
}

class SimBenchmark : public Benchmark {
 public:
  const char* name() const override { return "sim"; }
  const char* description() const override {
    return "Work and precision of the contact simulator";
  }

  void AddFlags(CLI::App& command) override {
    command.add_flag("--all", options_.all,
                     "Compare every trial, and random scenes, with the "
                     "reference");
    command
        .add_option("--random", options_.random_scenes,
                    "Random scenes of --all")
        ->capture_default_str();
    command
        .add_option("--budget", options_.budget,
                    "Processor time of the comparisons of --all, s")
        ->capture_default_str();
    command.add_option("--table", table_, "Write the table as CSV");
    command.add_option("--figure", figure_, "Draw work and precision as PNG");
  }

  absl::StatusOr<std::vector<BenchRow>> Run(bool quick) override {
    SimBenchOptions options = options_;
    options.quick = quick;
    TACTUS_ASSIGN_OR_RETURN(const SimReport report, MeasureSim(options));
    if (!table_.empty()) {
      std::ofstream file(table_);
      file << WorkTable(report.points);
      if (!file.flush()) return IoError(table_, "cannot be written");
    }
    if (!figure_.empty()) {
      TACTUS_RETURN_IF_ERROR(WritePng(WorkFigure(report.points), figure_));
    }
    return report.rows;
  }

 private:
  SimBenchOptions options_;
  std::string table_;
  std::string figure_;
};

}  // namespace

std::unique_ptr<Benchmark> MakeSimBenchmark() {
  return std::make_unique<SimBenchmark>();
}

}  // namespace tactus::client
