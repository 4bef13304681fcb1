#include "core/eval/out_of_fold.h"

#include <algorithm>
#include <utility>

#include "core/base/status_macros.h"
#include "core/contacts/folds.h"
#include "core/train/calibrate.h"
#include "core/train/fit.h"

namespace tactus::internal {
namespace {

using Contacts = std::vector<const LabelledContact*>;

// Scores the contacts of `fold` with a model of those of `training`.
absl::Status ScoreFold(const Contacts& contacts, const std::vector<int>& fold,
                       const std::vector<int>& training,
                       const FitOptions& options, const Progress& progress,
                       std::vector<ScoredContact>& scores) {
  Contacts rest;
  for (const int i : training) rest.push_back(contacts[i]);
  TACTUS_ASSIGN_OR_RETURN(Model model,
                          FitModel(rest, options, RunSerially, progress));
  TACTUS_ASSIGN_OR_RETURN(const auto compiled,
                          CompiledModel::Create(std::move(model)));
  const std::vector<double> frames =
      FramesToCalibrate(contacts, options, compiled->model().inputs);
  for (const int i : fold) {
    scores[i] = ScoreContact(compiled, *contacts[i], frames);
  }
  return absl::OkStatus();
}

// The class with the highest score after the last calibration time: of the
// LSTMs if there are some, else of the HMMs or of the ridge.
int AnswerOf(const ScoredContact& scored) {
  const std::vector<double>& scores = scored.lstm_score.empty()
                                          ? scored.log_likelihood.back()
                                          : scored.lstm_score.back();
  return static_cast<int>(std::ranges::max_element(scores) - scores.begin());
}

}  // namespace

absl::StatusOr<std::vector<bool>> RightOutOfFold(
    const Contacts& contacts, const std::vector<std::vector<int>>& folds,
    const FitOptions& options, const ParallelFor& parallel,
    const Progress& progress) {
  std::vector<std::vector<int>> training;
  for (const std::vector<int>& fold : folds) {
    training.push_back(Complement(fold, static_cast<int>(contacts.size())));
  }
  return RightOutOfFold(contacts, folds, training, options, parallel, progress);
}

absl::StatusOr<std::vector<bool>> RightOutOfFold(
    const Contacts& contacts, const std::vector<std::vector<int>>& folds,
    const std::vector<std::vector<int>>& training, const FitOptions& options,
    const ParallelFor& parallel, const Progress& progress) {
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
    failures[f] = ScoreFold(contacts, folds[f], training[f], fit, each, scores);
  });
  for (const absl::Status& failure : failures) {
    TACTUS_RETURN_IF_ERROR(failure);
  }
  std::vector<bool> right;
  for (const ScoredContact& scored : scores) {
    right.push_back(AnswerOf(scored) == scored.labels.back());
  }
  return right;
}

}  // namespace tactus::internal
