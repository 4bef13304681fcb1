#include <algorithm>
#include <cmath>
#include <vector>

#include "absl/strings/str_format.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/hmm/baum_welch.h"
#include "core/hmm/init.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/ghmm_peer.h"
#include "tests/bench/hmm_models.h"
#include "tests/bench/timing.h"

namespace tactus::internal::client {
namespace {

// Both optimisers run so long for the comparison of their optima; a tolerance
// of 0 nats lets neither stop early.
constexpr int kConvergedIterations = 200;
constexpr double kSameOptimum = 1e-6;

BaumWelchOptions Options(int iterations) {
  return {
      .max_iterations = iterations, .tolerance = 0, .covariance_floor = 1e-9};
}

// Log-likelihood of the model's trials.
absl::StatusOr<double> LogLikelihood(const std::vector<SequenceView>& trials,
                                     GaussianHmm model) {
  TACTUS_ASSIGN_OR_RETURN(const BaumWelchReport report,
                          BaumWelch(trials, Options(0), model));
  return report.log_likelihood.back();
}

// Fails if libghmm makes fewer than `count` updates when it is asked for them,
// as it would if it stopped early: its time would be divided by too many.
absl::Status CheckUpdates(const std::vector<SequenceView>& trials,
                          const GaussianHmm& start, int count) {
  const auto one_less = MakeGhmmPeer(start);
  const auto all = MakeGhmmPeer(start);
  TACTUS_RETURN_IF_ERROR(one_less->Train(trials, count - 1));
  TACTUS_RETURN_IF_ERROR(all->Train(trials, count));
  if (all->model().means == one_less->model().means) {
    return NumericalFailure(
        absl::StrFormat("libghmm makes fewer than %d updates", count));
  }
  return absl::OkStatus();
}

absl::StatusOr<BenchRow> Measure(bool quick) {
  Random random(2);
  const GaussianHmm source = DrawLeftRightModel(10, 3, random);
  std::vector<std::vector<double>> data;
  std::vector<SequenceView> trials;
  for (int s = 0; s < 20; ++s) {
    data.push_back(DrawTrial(source, 200 + 5 * s, random));
  }
  for (const std::vector<double>& trial : data) {
    trials.push_back({trial.data(), static_cast<int>(trial.size()) / 3, 3});
  }
  TACTUS_ASSIGN_OR_RETURN(const GaussianHmm start, InitPaper(trials, {}));
  BenchRow row{
      .name = "train-hmm/iteration", .unit = "ns", .peer_name = "libghmm"};

  GaussianHmm ours = start;
  TACTUS_RETURN_IF_ERROR(
      BaumWelch(trials, Options(kConvergedIterations), ours).status());
  const auto converged_peer = MakeGhmmPeer(start);
  if (converged_peer != nullptr) {
    TACTUS_RETURN_IF_ERROR(converged_peer->Train(trials, kConvergedIterations));
    TACTUS_ASSIGN_OR_RETURN(const double our_optimum,
                            LogLikelihood(trials, ours));
    TACTUS_ASSIGN_OR_RETURN(const double peer_optimum,
                            LogLikelihood(trials, converged_peer->model()));
    row.error = std::abs(our_optimum / peer_optimum - 1);
    row.error_reference = "libghmm's optimum, relative";
    if (!(*row.error <= kSameOptimum)) {
      return NumericalFailure(absl::StrFormat(
          "log-likelihood %.9g where libghmm ends; %.9g where we do",
          peer_optimum, our_optimum));
    }
  }

  // libghmm stops by itself a few updates later.
  constexpr int kIterations = 3;
  absl::Status failure;
  if (converged_peer != nullptr) {
    TACTUS_RETURN_IF_ERROR(CheckUpdates(trials, start, kIterations));
  }
  const Timing timing = Interleave(
      quick ? 3 : 15,
      [&] {
        GaussianHmm model = start;
        failure.Update(BaumWelch(trials, Options(kIterations), model).status());
      },
      [&] {
        const auto peer = MakeGhmmPeer(start);
        if (peer != nullptr) failure.Update(peer->Train(trials, kIterations));
      });
  TACTUS_RETURN_IF_ERROR(failure);
  const double unit =
      1e9 / (static_cast<double>(TotalFrames(trials)) * kIterations);
  row.ours = timing.ours * unit;
  if (converged_peer != nullptr) row.peer = timing.peer * unit;
  return row;
}

class TrainHmmBenchmark : public Benchmark {
 public:
  const char* name() const override { return "train-hmm"; }
  const char* description() const override {
    return "Training an HMM by Baum-Welch";
  }

  absl::StatusOr<std::vector<BenchRow>> Run(bool quick) override {
    TACTUS_ASSIGN_OR_RETURN(BenchRow row, Measure(quick));
    return std::vector<BenchRow>{row};
  }
};

}  // namespace

std::unique_ptr<Benchmark> MakeTrainHmmBenchmark() {
  return std::make_unique<TrainHmmBenchmark>();
}

}  // namespace tactus::internal::client
