#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "absl/strings/str_format.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/inputs/inputs.h"
#include "core/train/fit.h"
#include "tests/bench/frontier.h"
#include "tests/bench/hmm_models.h"
#include "tests/bench/hmm_scorers.h"
#include "tests/bench/timing.h"
#include "tools/common/percentile.h"

namespace tactus::internal::client {
namespace {

constexpr int kContacts = 100;
constexpr int kQuickContacts = 4;
constexpr int kPrecisionRounds = 15;
// The error of dropped states has no bound that is known beforehand.
constexpr double kNoTolerance = std::numeric_limits<double>::infinity();

// The HMM inputs of a contact until kFrontierSeconds after onset, and their
// reference scores.
struct Sequence {
  std::vector<double> observations;
  int label = 0;
  std::vector<long double> truth;  // one score per class
};

std::vector<Sequence> MakeSequences(
    const Model& model, const std::vector<LabelledContact>& contacts,
    int count) {
  std::vector<Sequence> sequences;
  for (int i = 0; i < count; ++i) {
    LabelledContact contact = contacts[i];
    const auto frames =
        static_cast<size_t>(kFrontierSeconds * contact.sample_rate_hz);
    contact.frames.clear();
    for (size_t t = 0; t < std::min(frames, contacts[i].frames.size()); ++t) {
      contact.frames.push_back(contacts[i].frames[t]);
    }
    Sequence sequence;
    sequence.observations =
        MakeSequence(contact, model.inputs.hmm, model.inputs.hmm_steps);
    sequence.label =
        static_cast<int>(std::ranges::find(model.class_names, contact.label) -
                         model.class_names.begin());
    for (const HmmMixture& mixture : model.hmms) {
      std::vector<long double> scores;
      for (size_t k = 0; k < mixture.components.size(); ++k) {
        scores.push_back(mixture.log_weight[k] +
                         ReferenceScore(mixture.components[k], Score::kForward,
                                        sequence.observations));
      }
      sequence.truth.push_back(LogSumExp(std::span<const long double>(scores)));
    }
    sequences.push_back(std::move(sequence));
  }
  return sequences;
}

void ScoreSequence(const Sequence& sequence, size_t dimensions,
                   HmmScorer& scorer, std::vector<double>& scores) {
  scorer.Reset();
  const std::span<const double> all(sequence.observations);
  for (size_t t = 0; t < all.size(); t += dimensions) {
    scorer.Step(all.subspan(t, dimensions));
    scorer.Scores(scores);
  }
}

struct NamedScorer {
  const char* family;
  const char* name;
  // Largest error allowed, relative to the log-likelihood.
  double tolerance;
  std::unique_ptr<HmmScorer> scorer;
};

absl::StatusOr<std::vector<NamedScorer>> MakeScorers(
    const std::vector<HmmMixture>& mixtures) {
  TACTUS_ASSIGN_OR_RETURN(auto served, MakeServedScorer(mixtures));
  TACTUS_ASSIGN_OR_RETURN(auto logarithms, MakeLogarithmScorer(mixtures));
  std::vector<NamedScorer> scorers;
  scorers.push_back({"scaled", "float as served", 1e-6, std::move(served)});
  scorers.push_back({"scaled", "double", 1e-12, MakeDoubleScorer(mixtures)});
  scorers.push_back({"logarithms", "double", 1e-12, std::move(logarithms)});
  constexpr std::pair<const char*, double> kBounds[] = {{"bound 0", 0},
                                                        {"bound 1e-12", 1e-12},
                                                        {"bound 1e-8", 1e-8},
                                                        {"bound 1e-4", 1e-4}};
  for (const auto& [name, bound] : kBounds) {
    scorers.push_back(
        {"pruned", name, kNoTolerance, MakePrunedScorer(mixtures, bound)});
  }
  return scorers;
}

// Returns error and accuracy, or NUMERICAL_FAILURE if an error exceeds the
// tolerance.
absl::StatusOr<FrontierPoint> Check(const NamedScorer& named,
                                    const std::vector<Sequence>& sequences,
                                    size_t dimensions) {
  double worst = 0;
  int right = 0;
  for (const Sequence& sequence : sequences) {
    std::vector<double> scores(sequence.truth.size());
    ScoreSequence(sequence, dimensions, *named.scorer, scores);
    const double steps = static_cast<double>(sequence.observations.size()) /
                         static_cast<double>(dimensions);
    for (size_t c = 0; c < scores.size(); ++c) {
      const auto off =
          static_cast<double>(std::abs(scores[c] - sequence.truth[c]));
      const auto scale =
          static_cast<double>(std::abs(sequence.truth[c])) + steps;
      if (!(off <= named.tolerance * scale)) {
        return NumericalFailure(absl::StrFormat(
            "%s, %s: a log-likelihood of %g has an error of %g; at most a "
            "fraction %g would be right",
            named.family, named.name, scale, off, named.tolerance));
      }
      worst = std::max(worst, off / steps);
    }
    right +=
        std::ranges::max_element(scores) - scores.begin() == sequence.label;
  }
  return FrontierPoint{
      .comparison = Comparison::kPrecision,
      .family = named.family,
      .variant = named.name,
      .error = worst,
      .error_reference = "logarithms in long double, nats per scored frame",
      .contacts = sequences.size(),
      .accuracy =
          static_cast<double>(right) / static_cast<double>(sequences.size())};
}

}  // namespace

absl::StatusOr<std::vector<FrontierPoint>> MeasurePrecision(
    const Model& model, const std::vector<LabelledContact>& contacts,
    bool quick) {
  const std::vector<Sequence> sequences =
      MakeSequences(model, contacts, quick ? kQuickContacts : kContacts);
  const size_t dimensions = model.inputs.hmm.size();
  TACTUS_ASSIGN_OR_RETURN(const std::vector<NamedScorer> scorers,
                          MakeScorers(model.hmms));
  std::vector<FrontierPoint> points;
  for (const NamedScorer& named : scorers) {
    TACTUS_ASSIGN_OR_RETURN(points.emplace_back(),
                            Check(named, sequences, dimensions));
  }
  size_t steps = 0;
  for (const Sequence& sequence : sequences) {
    steps += sequence.observations.size() / dimensions;
  }
  std::vector<double> scores(model.hmms.size());
  std::vector<std::vector<double>> seconds(scorers.size());
  for (int round = 0; round < (quick ? 2 : kPrecisionRounds); ++round) {
    for (size_t r = 0; r < scorers.size(); ++r) {
      const double start = ThreadSeconds();
      for (const Sequence& sequence : sequences) {
        ScoreSequence(sequence, dimensions, *scorers[r].scorer, scores);
      }
      seconds[r].push_back(ThreadSeconds() - start);
    }
  }
  for (size_t r = 0; r < scorers.size(); ++r) {
    points[r].nanoseconds =
        Percentile(seconds[r], 0.5) / static_cast<double>(steps) * 1e9;
  }
  return points;
}

}  // namespace tactus::internal::client
