#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/functional/function_ref.h"
#include "absl/strings/str_format.h"
#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/base/status_macros.h"
#include "core/sim/exact/contact_modes.h"
#include "core/sim/experiments/paper_set.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/sim_check.h"
#include "tests/bench/timing.h"
#include "tests/bench/work_precision.h"
#include "tools/figures/figure.h"

namespace tactus::internal::client {
namespace {

struct SimBenchOptions {
  // A few trials and tolerances, for tests.
  bool quick = false;
  // Also compares every trial of the paper's set and this many random scenes
  // with the reference.
  bool all = false;
  int random_scenes = 10'000;
  // Processor time of each of the two comparisons, s.
  double budget = 300;
};

struct SimReport {
  std::vector<BenchRow> rows;
  std::vector<WorkPoint> points;
};

constexpr char kReference[] =
    "long double matrix exponentials, every ringing period resolved";

// Every so many trials of the set are measured.
constexpr size_t kStride = 13;
constexpr size_t kQuickStride = 101;

// The two samples on which CVODE is measured. Gentle contacts have no trains of
// bounces and ring so slowly that CVODE resolves it, down to tight tolerances.
// In the others CVODE damps the ringing and misses bounces; at tight tolerances
// each would take minutes.
struct SampleLimits {
  const char* name;
  int64_t events;
  double ringing;  // rad/s
  std::vector<double> tolerances;
  std::vector<double> quick;
};

std::vector<SampleLimits> Samples() {
  return {{"gentle",
           50,
           5e3,
           {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10},
           {1e-2, 1e-4, 1e-6}},
          {"mixed", 20'000, 1e300, {1e-2, 1e-3, 1e-4}, {1e-2}}};
}

struct SimCase {
  TrialSpec spec;
  std::vector<FeatureVector> truth;
};

using Method =
    absl::FunctionRef<absl::StatusOr<SimulatedContact>(const TrialSpec&)>;

absl::StatusOr<WorkPoint> Measure(const std::vector<SimCase>& cases,
                                  Method simulate) {
  WorkPoint point;
  std::vector<double> errors;
  for (const SimCase& each : cases) {
    const double start = ThreadSeconds();
    TACTUS_ASSIGN_OR_RETURN(const SimulatedContact contact,
                            simulate(each.spec));
    point.seconds += ThreadSeconds() - start;
    errors.push_back(FeatureError(contact.signals.samples, each.truth));
  }
  std::sort(errors.begin(), errors.end());
  point.seconds /= cases.size();
  point.median_error = errors[errors.size() / 2];
  point.worst_error = errors.back();
  return point;
}

bool Within(const SampleLimits& limits, const SimulatedContact& contact) {
  const ContactModes modes(SceneOf(contact.spec));
  return contact.events.Total() <= limits.events &&
         std::max(modes.stuck.fastest(), modes.fast.fastest()) <=
             limits.ringing;
}

// The whole set as it is used: filtered, with noise. Lists its trials.
absl::StatusOr<double> SetSeconds(std::vector<TrialSpec>& trials) {
  const double start = ThreadSeconds();
  for (const TrialSpec& spec : TrialSpecs(PaperGrid().Conditions())) {
    TACTUS_ASSIGN_OR_RETURN(const auto contacts, SimulateWithTwin(spec));
    for (const SimulatedContact& contact : contacts) {
      const Trial trial = SignalTrial(contact, SignalNoise(), 1);
      if (trial.signals.empty()) return NumericalFailure("no signals");
      trials.push_back(contact.spec);
    }
  }
  return ThreadSeconds() - start;
}

absl::Status MeasureSample(const SampleLimits& limits,
                           const std::vector<TrialSpec>& trials, bool quick,
                           SimReport& report) {
  std::vector<SimCase> sample;
  WorstErrors worst;
  for (size_t i = 0; i < trials.size(); i += quick ? kQuickStride : kStride) {
    TACTUS_ASSIGN_OR_RETURN(const SimulatedContact contact,
                            SimulateContact(trials[i]));
    if (!Within(limits, contact)) continue;
    TACTUS_ASSIGN_OR_RETURN(auto truth, ReferenceFeatures(contact.spec));
    worst.Take(contact, truth);
    sample.push_back({contact.spec, std::move(truth)});
  }
  worst.Print(absl::StrFormat("%s sample", limits.name).c_str());
  TACTUS_RETURN_IF_ERROR(worst.Check());

  std::vector<double> skips = {0, 1e-6, 1e-3, 1e-1};
  if (quick) skips = {0, 1e-3};
  WorkPoint exact;  // at the default
  for (double tolerance : skips) {
    TACTUS_ASSIGN_OR_RETURN(WorkPoint point,
                            Measure(sample, [&](const TrialSpec& spec) {
                              return SimulateContact(spec, ExactAt(tolerance));
                            }));
    point.sample = limits.name;
    point.method = "exact";
    point.tolerance = tolerance;
    report.points.push_back(point);
    if (tolerance == ExactOptions().skip_tolerance) exact = point;
  }
  report.rows.push_back({.name = absl::StrFormat("sim/%s/exact", limits.name),
                         .unit = "s",
                         .ours = exact.seconds,
                         .error = exact.worst_error,
                         .error_reference = kReference});
  for (double tolerance : quick ? limits.quick : limits.tolerances) {
    TACTUS_ASSIGN_OR_RETURN(WorkPoint point,
                            Measure(sample, [&](const TrialSpec& spec) {
                              return SimulateByCvode(spec, CvodeAt(tolerance));
                            }));
    point.sample = limits.name;
    point.method = "CVODE";
    point.tolerance = tolerance;
    report.points.push_back(point);
    report.rows.push_back(
        {.name = absl::StrFormat("sim/%s/CVODE-%g", limits.name, tolerance),
         .unit = "s",
         .ours = exact.seconds,
         .peer = point.seconds,
         .peer_name =
             absl::StrFormat("CVODE at relative tolerance %g, error %.2g",
                             tolerance, point.worst_error),
         .error = exact.worst_error,
         .error_reference = kReference});
  }
  return absl::OkStatus();
}

absl::StatusOr<SimReport> MeasureSim(const SimBenchOptions& options) {
  SimReport report;
  std::vector<TrialSpec> trials;
  TACTUS_ASSIGN_OR_RETURN(const double seconds, SetSeconds(trials));
  report.rows.push_back(
      {.name = "sim/paper-set", .unit = "s", .ours = seconds});
  for (const SampleLimits& limits : Samples()) {
    TACTUS_RETURN_IF_ERROR(
        MeasureSample(limits, trials, options.quick, report));
  }
  if (!options.all) return report;

  TACTUS_ASSIGN_OR_RETURN(
      const SceneComparison set,
      CompareScenes("paper's set", trials.size(), options.budget,
                    // Mixed, so that what the time allows is a fair sample.
                    [&](int i) { return trials[i * 997 % trials.size()]; }));
  Random random(1);
  TACTUS_ASSIGN_OR_RETURN(
      const SceneComparison scenes,
      CompareScenes("random scenes", options.random_scenes, options.budget,
                    [&](int) { return RandomSpec(random); }));
  report.rows.front().error = set.worst.error();
  report.rows.front().error_reference = kReference;
  report.rows.push_back({.name = "sim/random-scenes",
                         .unit = "s",
                         .ours = scenes.seconds,
                         .error = scenes.worst.error(),
                         .error_reference = kReference});
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
                    "Processor time of each comparison of --all, s")
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
      TACTUS_RETURN_IF_ERROR(DrawFigure(WorkFigure(report.points), figure_));
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

}  // namespace tactus::internal::client
