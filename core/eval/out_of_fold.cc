#include "core/eval/out_of_fold.h"

#include <algorithm>
#include <utility>

#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/status_proto.h"
#include "core/contacts/folds.h"
#include "core/train/archive.h"
#include "core/train/calibrate.h"
#include "core/train/fit.h"
#include "core/train/fit_journal.h"

namespace tactus::internal {
namespace {

using Contacts = std::vector<const LabelledContact*>;

// The class with the highest score after the last calibration time: of the
// LSTMs if there are some, else of the HMMs or of the ridge.
int AnswerOf(const ScoredContact& scored) {
  const std::vector<double>& scores = scored.lstm_score.empty()
                                          ? scored.log_likelihood.back()
                                          : scored.lstm_score.back();
  return static_cast<int>(std::ranges::max_element(scores) - scores.begin());
}

// Asks whether a fit shall end, and keeps nothing of it.
class EndAsked : public FitJournal {
 public:
  explicit EndAsked(const std::function<bool()>& cancelled)
      : cancelled_(cancelled) {}

  bool KeepsParts() const override { return false; }
  bool Cancelled() override { return cancelled_ && cancelled_(); }

 private:
  const std::function<bool()>& cancelled_;
};

// Answers the contacts of `fold` with a model of those of `training`: 1 for
// each that is right.
absl::Status AnswerFold(const Contacts& contacts, const std::vector<int>& fold,
                        const std::vector<int>& training,
                        const FitOptions& options, const Progress& progress,
                        FitJournal& asked, std::vector<int>& answers) {
  Contacts rest;
  for (const int i : training) rest.push_back(contacts[i]);
  TACTUS_ASSIGN_OR_RETURN(
      Model model, FitModel(rest, options, RunSerially, progress, &asked));
  TACTUS_ASSIGN_OR_RETURN(const auto compiled,
                          CompiledModel::Create(std::move(model)));
  const std::vector<double> frames =
      FramesToCalibrate(contacts, options, compiled->model().inputs);
  for (const int i : fold) {
    if (asked.Cancelled()) return WorkCancelled("the comparison");
    const ScoredContact scored = ScoreContact(compiled, *contacts[i], frames);
    answers.push_back(AnswerOf(scored) == scored.labels.back());
  }
  return absl::OkStatus();
}

// What became of a fold.
struct FoldResult {
  std::string failure;  // a Status; empty if it went well
  std::vector<int> answers;
};
template <class Archive>
void Fields(Archive& archive, FoldResult& result) {
  archive(result.failure, result.answers);
}

// Gives all ranks the results of all folds.
absl::Status ExchangeResults(const std::vector<int>& owner, Ranks& ranks,
                             std::vector<FoldResult>& results) {
  ByteWriter writer;
  for (size_t f = 0; f < results.size(); ++f) {
    if (owner[f] == ranks.rank()) writer(results[f]);
  }
  TACTUS_ASSIGN_OR_RETURN(const auto all, ranks.Exchange(writer.Take()));
  std::vector<ByteReader> readers(all.begin(), all.end());
  for (size_t f = 0; f < results.size(); ++f) readers[owner[f]](results[f]);
  return absl::OkStatus();
}

absl::Status FailureOf(const FoldResult& result) {
  if (result.failure.empty()) return absl::OkStatus();
  v1::Status failure;
  if (!failure.ParseFromString(result.failure)) {
    return CheckpointInvalid("fold", "a rank has sent another result");
  }
  return FromStatusProto(failure);
}

}  // namespace

absl::StatusOr<std::vector<bool>> RightOutOfFold(
    const Contacts& contacts, const std::vector<std::vector<int>>& folds,
    const FitOptions& options, const ParallelFor& parallel,
    const Progress& progress, Ranks* ranks,
    const std::function<bool()>& cancelled) {
  std::vector<std::vector<int>> training;
  for (const std::vector<int>& fold : folds) {
    training.push_back(Complement(fold, static_cast<int>(contacts.size())));
  }
  return RightOutOfFold(contacts, folds, training, options, parallel, progress,
                        ranks, cancelled);
}

absl::StatusOr<std::vector<bool>> RightOutOfFold(
    const Contacts& contacts, const std::vector<std::vector<int>>& folds,
    const std::vector<std::vector<int>>& training, const FitOptions& options,
    const ParallelFor& parallel, const Progress& progress, Ranks* given_ranks,
    const std::function<bool()>& cancelled) {
  FitOptions fit = options;
  fit.calibrate = false;
  fit.held_out = 0;
  // The estimator answers no question about classes.
  fit.lstm.estimates = false;
  OneRank alone;
  Ranks& ranks = given_ranks == nullptr ? alone : *given_ranks;
  std::vector<double> weights;
  for (const std::vector<int>& rest : training) {
    weights.push_back(static_cast<double>(rest.size()));
  }
  const std::vector<int> owner = ShareOut(weights, ranks.size());
  std::vector<int> own;
  for (size_t f = 0; f < folds.size(); ++f) {
    if (owner[f] == ranks.rank()) own.push_back(static_cast<int>(f));
  }
  const Progress each =
      progress.Part("", 1 / static_cast<double>(folds.size()));
  EndAsked asked(cancelled);
  std::vector<FoldResult> results(folds.size());
  parallel(static_cast<int>(own.size()), [&](int k) {
    const int f = own[k];
    const absl::Status scored = AnswerFold(contacts, folds[f], training[f], fit,
                                           each, asked, results[f].answers);
    if (!scored.ok()) {
      results[f].failure = ToStatusProto(scored).SerializeAsString();
    }
  });
  TACTUS_RETURN_IF_ERROR(ExchangeResults(owner, ranks, results));
  for (const FoldResult& result : results) {
    TACTUS_RETURN_IF_ERROR(FailureOf(result));
  }
  std::vector<bool> right(contacts.size());
  for (size_t f = 0; f < folds.size(); ++f) {
    for (size_t k = 0; k < folds[f].size(); ++k) {
      right[folds[f][k]] = results[f].answers[k] != 0;
    }
  }
  return right;
}

}  // namespace tactus::internal
