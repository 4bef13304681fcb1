#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_format.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/hmm/hmm_bank.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/ghmm_peer.h"
#include "tests/bench/hmm_models.h"
#include "tests/bench/timing.h"

namespace tactus::internal::client {
namespace {

constexpr int kStates = 10;
constexpr int kDimensions = 3;
constexpr char kReference[] = "long double, relative";

struct Shape {
  const char* name;
  int categories;
  int components;  // of each class
  Score score;
  // Scores are read on every frame, as a stream does; else at the end, as
  // libghmm gives them.
  bool streams;
  // What a time is divided by, besides frames.
  int models_of_unit;
  // Largest relative error of a right answer.
  double tolerance;
};

constexpr Shape kShapes[] = {
    {"hmm/forward", 4, 1, Score::kForward, false, 4, 1e-6},
    {"hmm/viterbi", 4, 1, Score::kViterbi, false, 4, 1e-6},
    {"hmm/default-bundle", 4, 20, Score::kForward, true, 1, 1e-6},
};

std::vector<HmmMixture> DrawCategories(const Shape& shape, Random& random) {
  std::vector<HmmMixture> categories(shape.categories);
  for (HmmMixture& category : categories) {
    for (int k = 0; k < shape.components; ++k) {
      category.log_weight.push_back(-std::log(shape.components));
      category.components.push_back(
          DrawLeftRightModel(kStates, kDimensions, random));
    }
  }
  return categories;
}

// Scores of all classes after `observations`.
void ScoreOurs(const Shape& shape, BankFilter& filter,
               const std::vector<double>& observations,
               std::vector<double>& scores) {
  filter.Reset();
  for (size_t t = 0; t < observations.size(); t += kDimensions) {
    filter.Step({&observations[t], kDimensions});
    if (shape.streams) filter.LogLikelihood(scores);
  }
  filter.LogLikelihood(scores);
}

// Largest relative difference of a class's score from the reference.
double RelativeError(const std::vector<HmmMixture>& categories, Score score,
                     const std::vector<double>& observations,
                     const std::vector<double>& got) {
  double worst = 0;
  for (size_t c = 0; c < categories.size(); ++c) {
    std::vector<long double> scores;
    for (size_t k = 0; k < categories[c].components.size(); ++k) {
      scores.push_back(
          categories[c].log_weight[k] +
          ReferenceScore(categories[c].components[k], score, observations));
    }
    const long double best = *std::ranges::max_element(scores);
    long double sum = 0;
    for (const long double s : scores) sum += std::exp(s - best);
    const long double want = best + std::log(sum);
    worst =
        std::max(worst, static_cast<double>(std::abs((got[c] - want) / want)));
  }
  return worst;
}

absl::StatusOr<BenchRow> Measure(const Shape& shape, bool quick) {
  Random random(1);
  const std::vector<HmmMixture> categories = DrawCategories(shape, random);
  TACTUS_ASSIGN_OR_RETURN(const HmmBank bank, HmmBank::Create(categories));
  BankFilter ours(bank, shape.score);
  std::vector<double> scores(categories.size());
  const GaussianHmm& source = categories[0].components[0];

  const bool many = shape.components > 1;
  const int long_frames = (quick ? 1'000 : 100'000) / (many ? 10 : 1);
  const std::vector<double> contact = DrawTrial(source, long_frames, random);
  ScoreOurs(shape, ours, contact, scores);
  const double error = RelativeError(categories, shape.score, contact, scores);
  if (!(error <= shape.tolerance)) {
    return NumericalFailure(
        absl::StrFormat("%s: relative error %g; at most %g would be right",
                        shape.name, error, shape.tolerance));
  }

  const int frames = quick ? 200 : 1'000 / (many ? 2 : 1);
  std::vector<double> trial = DrawTrial(source, frames, random);
  std::vector<std::unique_ptr<GhmmPeer>> peers;
  for (const HmmMixture& category : categories) {
    for (const GaussianHmm& model : category.components) {
      peers.push_back(MakeGhmmPeer(model));
    }
  }
  const bool has_peer = peers.front() != nullptr;
  absl::Status failure;
  const Timing timing = Interleave(
      quick ? 3 : 15, [&] { ScoreOurs(shape, ours, trial, scores); },
      [&] {
        for (const auto& peer : peers) {
          if (!has_peer) return;
          failure.Update((shape.score == Score::kForward
                              ? peer->LogLikelihood(trial)
                              : peer->ViterbiScore(trial))
                             .status());
        }
      });
  TACTUS_RETURN_IF_ERROR(failure);
  const double unit =
      1e9 / (static_cast<double>(frames) * shape.models_of_unit);
  BenchRow row{.name = shape.name,
               .unit = "ns",
               .ours = timing.ours * unit,
               .peer_name = "libghmm",
               .error = error,
               .error_reference = kReference};
  if (has_peer) row.peer = timing.peer * unit;
  return row;
}

class HmmBenchmark : public Benchmark {
 public:
  const char* name() const override { return "hmm"; }
  const char* description() const override {
    return "Scoring a frame with HMMs";
  }

  absl::StatusOr<std::vector<BenchRow>> Run(bool quick) override {
    std::vector<BenchRow> rows;
    for (const Shape& shape : kShapes) {
      TACTUS_ASSIGN_OR_RETURN(rows.emplace_back(), Measure(shape, quick));
    }
    return rows;
  }
};

}  // namespace

std::unique_ptr<Benchmark> MakeHmmBenchmark() {
  return std::make_unique<HmmBenchmark>();
}

}  // namespace tactus::internal::client
