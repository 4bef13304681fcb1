#include "client/bench/sim.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/strings/str_format.h"
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
  // Also compares every trial of the paper's set, not only the sample, and
  // this many random scenes with the reference. Takes many minutes.
  bool all = false;
  int random_scenes = 10'000;
};

struct SimReport {
  std::vector<BenchRow> rows;
  // method,tolerance,seconds,median_error,worst_error,trials as CSV.
  std::string table;
};

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

// All trials of the paper's set, twins included.
absl::StatusOr<std::vector<SimulatedContact>> PaperSet() {
  std::vector<SimulatedContact> contacts;
  TACTUS_RETURN_IF_ERROR(ForEachContact(TrialSpecs(PaperConditions()), {},
                                        [&](const SimulatedContact& contact) {
                                          contacts.push_back(contact);
                                          return absl::OkStatus();
                                        }));
  return contacts;
}

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

absl::StatusOr<SimReport> MeasureSim(const SimBenchOptions& options) {
  SimReport report;

  // The whole set as it is used: filtered, with noise.
  double whole = 0;
  {
    const double start = ThreadSeconds();
    TACTUS_RETURN_IF_ERROR(ForEachContact(
        TrialSpecs(PaperConditions()), {}, [](const SimulatedContact& contact) {
          const Trial trial = SignalTrial(contact, SignalNoise(), 1);
          return trial.signals.empty() ? NumericalFailure("no signals")
                                       : absl::OkStatus();
        }));
    whole = ThreadSeconds() - start;
  }
  TACTUS_ASSIGN_OR_RETURN(const auto contacts, PaperSet());

  // The sample, and the truth of it.
  std::vector<Case> sample;
  double worst = 0;
  const size_t stride = options.quick ? kQuickStride : kStride;
  for (size_t i = 0; i < contacts.size(); ++i) {
    const SimulatedContact& contact = contacts[i];
    const bool sampled =
        i % stride == 0 && contact.events.Total() <= kSampleEvents;
    if (!sampled && !options.all) continue;
    TACTUS_ASSIGN_OR_RETURN(auto truth, Truth(contact.spec));
    worst = std::max(worst, FeatureError(contact.signals.samples, truth));
    if (sampled) sample.push_back({contact.spec, std::move(truth)});
  }

  report.table = "method,tolerance,seconds,median_error,worst_error,trials\n";
  const auto tabulate = [&](absl::string_view method, double tolerance,
                            const Work& work) {
    absl::StrAppendFormat(&report.table, "%s,%g,%.6g,%.3g,%.3g,%d\n", method,
                          tolerance, work.seconds, work.Median(), work.Worst(),
                          sample.size());
  };
  TACTUS_ASSIGN_OR_RETURN(const Work exact, Measure(sample, {}));
  tabulate("exact", 0, exact);
  report.rows.push_back({.name = "sim/paper-set",
                         .unit = "s",
                         .ours = whole,
                         .error = worst,
                         .error_reference = kReference});
  std::vector<double> tolerances = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8};
  if (options.quick) tolerances = {1e-2, 1e-4};
  for (double tolerance : tolerances) {
    TACTUS_ASSIGN_OR_RETURN(const Work cvode,
                            Measure(sample, Cvode(tolerance)));
    tabulate("cvode", tolerance, cvode);
    report.rows.push_back({.name = absl::StrFormat("sim/cvode-%g", tolerance),
                           .unit = "s",
                           .ours = exact.seconds,
                           .peer = cvode.seconds,
                           .peer_name = absl::StrFormat(
                               "CVODE at relative tolerance %g, error %.2g",
                               tolerance, cvode.Worst()),
                           .error = exact.Worst(),
                           .error_reference = kReference});
  }

  if (options.all) {
    Random random(1);
    double worst_random = 0;
    double seconds = 0;
    for (int i = 0; i < options.random_scenes; ++i) {
      const TrialSpec spec = RandomSpec(random);
      const double start = ThreadSeconds();
      TACTUS_ASSIGN_OR_RETURN(const SimulatedContact contact,
                              SimulateContact(spec));
      seconds += ThreadSeconds() - start;
      TACTUS_ASSIGN_OR_RETURN(const auto truth, Truth(spec));
      worst_random =
          std::max(worst_random, FeatureError(contact.signals.samples, truth));
    }
    report.rows.push_back({.name = "sim/random-scenes",
                           .unit = "s",
                           .ours = seconds,
                           .error = worst_random,
                           .error_reference = kReference});
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
                     "reference: many minutes");
    command
        .add_option("--random", options_.random_scenes,
                    "Random scenes of --all")
        ->capture_default_str();
    command.add_option("--table", table_, "Write the table as CSV");
  }

  absl::StatusOr<std::vector<BenchRow>> Run(bool quick) override {
    SimBenchOptions options = options_;
    options.quick = quick;
    TACTUS_ASSIGN_OR_RETURN(const SimReport report, MeasureSim(options));
    if (!table_.empty()) {
      std::ofstream file(table_);
      file << report.table;
      if (!file.flush()) return IoError(table_, "cannot be written");
    }
    return report.rows;
  }

 private:
  SimBenchOptions options_;
  std::string table_;
};

}  // namespace

std::unique_ptr<Benchmark> MakeSimBenchmark() {
  return std::make_unique<SimBenchmark>();
}

}  // namespace tactus::client
