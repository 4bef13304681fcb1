#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/str_format.h"
#include "core/base/errors.h"
#include "core/base/run_on_threads.h"
#include "core/base/status_macros.h"
#include "tests/bench/frontier.h"
#include "tests/bench/frontier_models.h"
#include "tests/bench/sim_check.h"
#include "tests/bench/timing.h"
#include "tools/common/percentile.h"

namespace tactus::internal::client {
namespace {

constexpr int kScenes = 48;
constexpr int kQuickScenes = 3;
constexpr int kSimRounds = 3;
// Contacts with more events would take CVODE minutes at tight tolerances.
constexpr int kMostEvents = 20'000;
// Largest error of the exact method if every bounce is solved.
constexpr double kSolvedBound = 1e-6;

struct Scene {
  TrialSpec spec;
  std::vector<FeatureVector> truth;
};

struct Method {
  std::string family;
  std::string name;
  std::function<absl::StatusOr<SimulatedContact>(const TrialSpec&)> simulate;
  // Largest error allowed; absent for a peer, whose error is only reported.
  std::optional<double> bound;
};

struct Work {
  double seconds = 0;
  double error = 0;
  std::vector<LabelledContact> contacts;
};

std::vector<Method> Methods(bool quick) {
  std::vector<Method> methods;
  for (const double skip : {0.0, 1e-4, 1e-3, 1e-2}) {
    methods.push_back(
        {"exact", skip == 0 ? "all bounces" : absl::StrFormat("skip %g", skip),
         [options = ExactAt(skip)](const TrialSpec& spec) {
           return SimulateContact(spec, options);
         },
         std::max(skip, kSolvedBound)});
  }
  for (const double tolerance : {1e-4, 1e-6}) {
    if (quick && tolerance < 1e-4) continue;
    methods.push_back({"CVODE",
                       absl::StrFormat("tolerance %g", tolerance),
                       [options = CvodeAt(tolerance)](const TrialSpec& spec) {
                         return SimulateByCvode(spec, options);
                       },
                       {}});
  }
  return methods;
}

// Scenes and their reference features, without scenes of too many events.
absl::StatusOr<std::vector<Scene>> MakeScenes(int count) {
  const std::vector<TrialSpec> specs = GridSpecs(count);
  std::vector<absl::StatusOr<Scene>> made(specs.size());
  RunOnThreads(count, [&](int i) {
    made[i] = [&]() -> absl::StatusOr<Scene> {
      SimulateOptions all;
      all.exact.skip_tolerance = 0;
      TACTUS_ASSIGN_OR_RETURN(const SimulatedContact contact,
                              SimulateContact(specs[i], all));
      if (contact.events.Total() > kMostEvents) return Scene{};
      TACTUS_ASSIGN_OR_RETURN(auto truth, ReferenceFeatures(specs[i]));
      return Scene{specs[i], std::move(truth)};
    }();
  });
  std::vector<Scene> scenes;
  for (absl::StatusOr<Scene>& scene : made) {
    TACTUS_RETURN_IF_ERROR(scene.status());
    if (!scene->truth.empty()) scenes.push_back(*std::move(scene));
  }
  if (scenes.empty()) return NumericalFailure("every scene has many events");
  return scenes;
}

absl::StatusOr<Work> Simulate(const Method& method, const Scene& scene,
                              int rounds) {
  Work work;
  std::vector<double> seconds;
  for (int round = 0; round < rounds; ++round) {
    const double start = ThreadSeconds();
    TACTUS_ASSIGN_OR_RETURN(const SimulatedContact contact,
                            method.simulate(scene.spec));
    seconds.push_back(ThreadSeconds() - start);
    if (round > 0) continue;
    work.error = FeatureError(contact.signals.samples, scene.truth);
    TACTUS_ASSIGN_OR_RETURN(work.contacts.emplace_back(),
                            ContactOf(contact, kTestSeed));
  }
  work.seconds = Percentile(seconds, 0.5);
  return work;
}

}  // namespace

absl::StatusOr<std::vector<FrontierPoint>> MeasureSimulators(
    const std::shared_ptr<const CompiledModel>& model, bool quick) {
  TACTUS_ASSIGN_OR_RETURN(const std::vector<Scene> scenes,
                          MakeScenes(quick ? kQuickScenes : kScenes));
  const std::vector<Method> methods = Methods(quick);
  std::vector<Work> total(methods.size());
  size_t frames = 0;
  for (const Scene& scene : scenes) {
    frames += scene.truth.size();
    for (size_t m = 0; m < methods.size(); ++m) {
      TACTUS_ASSIGN_OR_RETURN(
          Work work, Simulate(methods[m], scene, quick ? 1 : kSimRounds));
      total[m].seconds += work.seconds;
      total[m].error = std::max(total[m].error, work.error);
      total[m].contacts.push_back(std::move(work.contacts[0]));
    }
  }
  std::vector<FrontierPoint> points;
  for (size_t m = 0; m < methods.size(); ++m) {
    const Method& method = methods[m];
    if (method.bound && !(total[m].error <= *method.bound)) {
      return NumericalFailure(absl::StrFormat(
          "%s, %s has an error of %.2g, above %g", method.family, method.name,
          total[m].error, *method.bound));
    }
    TACTUS_ASSIGN_OR_RETURN(const double accuracy,
                            AccuracyOf(model, total[m].contacts));
    points.push_back(
        {.comparison = Comparison::kSimulator,
         .family = method.family,
         .variant = method.name,
         .nanoseconds = total[m].seconds / static_cast<double>(frames) * 1e9,
         .error = total[m].error,
         .error_reference =
             "long double matrix exponentials, share of the peak",
         .contacts = total[m].contacts.size(),
         .accuracy = accuracy});
  }
  return points;
}

}  // namespace tactus::internal::client
