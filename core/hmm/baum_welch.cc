#include "core/hmm/baum_welch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/base/status_macros.h"
#include "core/hmm/expectation.h"
#include "core/hmm/floored_covariance.h"

namespace tactus::internal {
namespace {

// Probability that is moved to a re-seeded state in each distribution.
constexpr double kReseedShare = 0.1;
constexpr int kMaxReseedsPerState = 3;
// A re-seeding is worthwhile only if at least this many updates follow.
constexpr int kUpdatesAfterReseed = 5;
// Relative rounding error that a sum of log-likelihoods may have.
constexpr double kRounding = 1e-9;

absl::Status CheckOptions(const BaumWelchOptions& options) {
  if (options.max_iterations < 0) {
    return InvalidConfig("max_iterations", options.max_iterations, "0 or more");
  }
  if (!(options.tolerance >= 0)) {
    return InvalidConfig("tolerance", options.tolerance, "0 or more");
  }
  if (!(options.covariance_floor > 0 &&
        std::isfinite(options.covariance_floor))) {
    return InvalidConfig("covariance_floor", options.covariance_floor,
                         "above 0 and finite");
  }
  if (!(options.transition_prior >= 0 &&
        std::isfinite(options.transition_prior))) {
    return InvalidConfig("transition_prior", options.transition_prior,
                         "0 or more and finite");
  }
  return absl::OkStatus();
}

void ScaleToOne(double* values, int count) {
  double sum = 0;
  for (int k = 0; k < count; ++k) sum += values[k];
  for (int k = 0; k < count; ++k) values[k] /= sum;
}

absl::Status RemoveBackwardTransitions(GaussianHmm& model) {
  const int n = model.states;
  for (int i = 0; i < n; ++i) {
    double* row = &model.transition[static_cast<size_t>(i) * n];
    double removed = 0;
    for (int j = 0; j < i; ++j) removed += std::exchange(row[j], 0.0);
    if (removed == 0) continue;
    if (std::all_of(row + i, row + n, [](double p) { return p == 0; })) {
      return InvalidModel(absl::StrCat("transition[", i, "]"),
                          "only to earlier states",
                          "with a way to stay or go on, as left_right asks");
    }
    ScaleToOne(row, n);
  }
  return absl::OkStatus();
}

// One training run.
class Trainer {
 public:
  Trainer(const std::vector<SequenceView>& sequences,
          const BaumWelchOptions& options, GaussianHmm& model)
      : sequences_(sequences),
        options_(options),
        model_(model),
        initial_(model),
        frames_(static_cast<double>(TotalFrames(sequences))),
        random_(options.seed),
        reseeds_(model.states, 0),
        expectation_(sequences),
        counts_(model.states, model.dimensions) {}

  absl::StatusOr<BaumWelchReport> Run(BaumWelchSink on_iteration) {
    double last_objective = 0;
    for (;; ++report_.iterations) {
      TACTUS_RETURN_IF_ERROR(Expect());
      const double objective = counts_.log_likelihood + LogPrior();
      if (!std::isfinite(objective)) {
        return NumericalFailure(absl::StrCat(
            "log-likelihood became ", objective, " after ", report_.iterations,
            " updates; finite would be right"));
      }
      report_.log_likelihood.push_back(counts_.log_likelihood);
      TACTUS_RETURN_IF_ERROR(on_iteration(report_));
      if (report_.iterations > 0) {
        const double gain = objective - last_objective;
        if (gain < -kRounding * (1 + std::abs(objective)) && !excused_) {
          report_.monotone = false;
        }
        if (gain < options_.tolerance * frames_ && !reseeded_) {
          report_.converged = true;
          break;
        }
      }
      if (report_.iterations == options_.max_iterations) break;
      last_objective = objective;
      Maximise();
    }
    return report_;
  }

 private:
  absl::Status Expect() {
    TACTUS_RETURN_IF_ERROR(Validate(model_));
    // The last model is scored but not updated.
    counts_ = expectation_.Compute(model_,
                                   report_.iterations < options_.max_iterations
                                       ? Counts::kAll
                                       : Counts::kLogLikelihood);
    return absl::OkStatus();
  }

  // Log of the prior of the transitions that the initial model allows, up to a
  // constant.
  double LogPrior() const {
    if (options_.transition_prior == 0) return 0;
    double sum = 0;
    for (size_t k = 0; k < model_.transition.size(); ++k) {
      if (initial_.transition[k] > 0) sum += std::log(model_.transition[k]);
    }
    return options_.transition_prior * sum;
  }

  void Maximise() {
    excused_ = false;
    reseeded_ = false;
    UpdateStart();
    const size_t n = model_.states;
    const size_t d = model_.dimensions;
    for (size_t i = 0; i < n; ++i) {
      UpdateTransitions(i, &counts_.transitions[i * n]);
    }
    // A state is dead if it explains less than one frame, and less than 1 % of
    // what it would explain if all states were equal.
    const double dead = std::min(1.0, 0.01 * frames_ / model_.states);
    for (size_t i = 0; i < n; ++i) {
      if (counts_.occupancy[i] >= dead) {
        UpdateEmission(i, 1 / counts_.occupancy[i],
                       &counts_.first_moment[i * d],
                       &counts_.second_moment[i * d * d]);
      } else if (reseeds_[i] < kMaxReseedsPerState &&
                 report_.iterations + kUpdatesAfterReseed <
                     options_.max_iterations) {
        Reseed(static_cast<int>(i));
      }
    }
  }

  void UpdateStart() {
    if (!options_.update_start) return;
    model_.start = counts_.starts;
    ScaleToOne(model_.start.data(), model_.states);
  }

  // taken: expected number of transitions to each state, [N]
  void UpdateTransitions(size_t state, const double* taken) {
    const int n = model_.states;
    const size_t offset = state * n;
    std::vector<double> row(n);
    double sum = 0;
    for (int j = 0; j < n; ++j) {
      row[j] = taken[j];
      if (initial_.transition[offset + j] > 0) {
        row[j] += options_.transition_prior;
      }
      sum += row[j];
    }
    // A state without observed transitions keeps its row.
    if (sum < 1e-30) return;
    for (int j = 0; j < n; ++j) model_.transition[offset + j] = row[j] / sum;
  }

  // weight: one over the expected number of frames; moments of this state,
  // see ExpectedCounts.
  void UpdateEmission(size_t state, double weight, const double* first,
                      const double* second) {
    const int d = model_.dimensions;
    double* mean = &model_.means[state * d];
    std::vector<double> covariance(static_cast<size_t>(d) * d);
    for (int a = 0; a < d; ++a) {
      mean[a] += first[a] * weight;
      for (int b = 0; b <= a; ++b) {
        covariance[a * d + b] = covariance[b * d + a] =
            second[a * d + b] * weight -
            (first[a] * weight) * (first[b] * weight);
      }
    }
    StoreCovariance(static_cast<int>(state), covariance);
  }

  // covariance: [D x D]
  void StoreCovariance(int state, std::vector<double>& covariance) {
    const bool raised = SetFlooredCovariance(
        covariance, options_.covariance_floor, state, model_);
    excused_ = excused_ || raised;
  }

  void Reseed(int state) {
    const int n = model_.states;
    const int d = model_.dimensions;
    const SequenceView& sequence = sequences_[random_.Index(sequences_.size())];
    double place = random_.Uniform();
    if (options_.left_right) place = (state + place) / n;
    const int t = std::min(static_cast<int>(place * sequence.frames),
                           sequence.frames - 1);
    std::ranges::copy(sequence.frame(t),
                      model_.means.begin() + static_cast<size_t>(state) * d);
    std::vector<double> covariance(static_cast<size_t>(d) * d, 0.0);
    const FrameMoments moments = ComputeFrameMoments(sequences_);
    for (int k = 0; k < d; ++k) covariance[k * d + k] = moments.variance[k];
    StoreCovariance(state, covariance);
    std::copy_n(&initial_.transition[static_cast<size_t>(state) * n], n,
                &model_.transition[static_cast<size_t>(state) * n]);
    for (int i = 0; i < n; ++i) {
      const size_t offset = static_cast<size_t>(i) * n;
      if (i != state && initial_.transition[offset + state] > 0) {
        OpenWay(&model_.transition[offset], state);
      }
    }
    if (options_.update_start && initial_.start[state] > 0) {
      OpenWay(model_.start.data(), state);
    }
    ++reseeds_[state];
    ++report_.reseeded_states;
    reseeded_ = excused_ = true;
  }

  // Moves kReseedShare of the distribution `row` [N] to `state`.
  void OpenWay(double* row, int state) {
    for (int j = 0; j < model_.states; ++j) row[j] *= 1 - kReseedShare;
    row[state] += kReseedShare;
  }

  const std::vector<SequenceView>& sequences_;
  const BaumWelchOptions& options_;
  GaussianHmm& model_;
  const GaussianHmm initial_;
  const double frames_;
  Random random_;
  std::vector<int> reseeds_;  // [N]
  Expectation expectation_;
  ExpectedCounts counts_;  // given model_
  BaumWelchReport report_;
  // True if the last update re-seeded a state or raised a covariance to the
  // floor. Either explains a lower likelihood.
  bool reseeded_ = false;
  bool excused_ = false;
};

}  // namespace

absl::StatusOr<BaumWelchReport> BaumWelch(
    const std::vector<SequenceView>& sequences, const BaumWelchOptions& options,
    GaussianHmm& model, BaumWelchSink on_iteration) {
  TACTUS_RETURN_IF_ERROR(CheckOptions(options));
  TACTUS_RETURN_IF_ERROR(Validate(sequences));
  TACTUS_RETURN_IF_ERROR(Validate(model));
  if (sequences.front().dimensions != model.dimensions) {
    return InvalidTrainingData(absl::StrCat(
        "sequences have ", sequences.front().dimensions, " dimensions; ",
        model.dimensions, ", as the model has, would be right"));
  }
  GaussianHmm trained = WithCovarianceType(model, options.covariance_type);
  if (options.left_right) {
    TACTUS_RETURN_IF_ERROR(RemoveBackwardTransitions(trained));
  }
  TACTUS_ASSIGN_OR_RETURN(
      BaumWelchReport report,
      Trainer(sequences, options, trained).Run(on_iteration));
  model = std::move(trained);
  return report;
}

}  // namespace tactus::internal
