#include "core/eval/out_of_fold.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/classify/calibration.h"
#include "core/contacts/folds.h"
#include "core/train/calibrate.h"
#include "core/train/fit.h"

namespace tactus {
namespace {

using Contacts = std::vector<const LabelledContact*>;

// Scores the contacts of `fold` with a model of all others.
absl::Status ScoreFold(const Contacts& contacts, const std::vector<int>& fold,
                       const FitOptions& options, const Progress& progress,
                       std::vector<ScoredContact>& scores) {
  Contacts rest;
  for (const int i : Complement(fold, static_cast<int>(contacts.size()))) {
    rest.push_back(contacts[i]);
  }
  TACTUS_ASSIGN_OR_RETURN(Model model,
                          FitModel(rest, options, RunSerially, progress));
  TACTUS_ASSIGN_OR_RETURN(const auto compiled,
                          CompiledModel::Create(std::move(model)));
  for (const int i : fold) scores[i] = ScoreContact(compiled, *contacts[i]);
  return absl::OkStatus();
}

// The most probable class after the last calibration time.
int AnswerOf(const ScoredContact& scored, const Calibration& calibration) {
  const CalibrationPoint point =
      CalibrationAt(calibration, calibration.frames.back());
  const std::vector<double>& log_likelihood = scored.log_likelihood.back();
  const size_t classes = log_likelihood.size();
  std::vector<double> log_prior(classes);
  for (size_t k = 0; k < classes; ++k) {
    log_prior[k] = std::log(calibration.prior[k]);
  }
  const auto posterior = [&](const std::vector<double>& score,
                             double inverse_temperature,
                             const std::vector<double>& table) {
    std::vector<double> bias(classes);
    BiasAt(table, point, bias);
    std::vector<double> probability(classes);
    TemperedPosterior(log_prior, score, inverse_temperature, bias, probability);
    return probability;
  };
  std::vector<double> answer = posterior(
      log_likelihood, point.hmm_inverse_temperature, calibration.hmm_bias);
  if (!scored.lstm_score.empty()) {
    const std::vector<double> lstm =
        posterior(scored.lstm_score.back(), point.lstm_inverse_temperature,
                  calibration.lstm_bias);
    std::vector<double> bias(classes);
    BiasAt(calibration.fused_bias, point, bias);
    std::vector<double> fused(classes);
    FusePosteriors(answer, lstm, point, bias, fused);
    answer = std::move(fused);
  }
  return static_cast<int>(std::ranges::max_element(answer) - answer.begin());
}

}  // namespace

absl::StatusOr<int> CountOutOfFoldRight(
    const Contacts& contacts, const std::vector<std::vector<int>>& folds,
    const FitOptions& options, const ParallelFor& parallel,
    const Progress& progress) {
  FitOptions fit = options;
  fit.calibrate = false;
  fit.held_out = 0;
  // The estimator answers no question about classes.
  fit.lstm.estimates = false;
  std::vector<ScoredContact> scores(contacts.size());
  std::vector<absl::Status> failures(folds.size());
  const Progress each =
      progress.Part("", 1 / static_cast<double>(folds.size()));
  parallel(static_cast<int>(folds.size()), [&](int f) {
    failures[f] = ScoreFold(contacts, folds[f], fit, each, scores);
  });
  for (const absl::Status& failure : failures) {
    TACTUS_RETURN_IF_ERROR(failure);
  }
  const size_t classes = ClassNames(contacts).size();
  int right = 0;
  for (const std::vector<int>& fold : folds) {
    std::vector<ScoredContact> others;
    for (const int i : Complement(fold, static_cast<int>(contacts.size()))) {
      others.push_back(scores[i]);
    }
    Calibration calibration;
    calibration.prior.assign(classes, 1.0 / static_cast<double>(classes));
    FitCalibration(others, contacts.front()->sample_rate_hz, calibration);
    for (const int i : fold) {
      right += AnswerOf(scores[i], calibration) == scores[i].labels.back();
    }
  }
  return right;
}

}  // namespace tactus
