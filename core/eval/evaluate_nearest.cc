#include "core/eval/evaluate_nearest.h"

#include <algorithm>
#include <cmath>

#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/contacts/folds.h"
#include "core/nearest/pca_nearest.h"

namespace tactus::internal {
namespace {

constexpr double kVarianceFraction = 0.95;

// Returns the first `frames` frames of a contact as one row, feature after
// feature. A shorter contact repeats its last frame.
Eigen::VectorXd Flatten(const LabelledContact& contact,
                        const std::vector<Feature>& features, int frames) {
  Eigen::VectorXd row(static_cast<Eigen::Index>(features.size()) * frames);
  Eigen::Index place = 0;
  for (Feature feature : features) {
    for (int t = 0; t < frames; ++t) {
      const size_t index = std::min<size_t>(t, contact.frames.size() - 1);
      row[place++] = contact.frames.features(index)[static_cast<int>(feature)];
    }
  }
  return row;
}

// Standardises each feature of `train` in place, over all samples and frames
// (paper, S_f), and applies the same map to `test`.
void Standardise(int features, int frames, Eigen::MatrixXd& train,
                 Eigen::MatrixXd& test) {
  for (int f = 0; f < features; ++f) {
    auto block = train.middleCols(f * frames, frames);
    const double mean = block.mean();
    const double deviation = std::sqrt((block.array() - mean).square().mean());
    const double gain = deviation > 0 ? 1 / deviation : 1;
    block.array() = (block.array() - mean) * gain;
    auto other = test.middleCols(f * frames, frames);
    other.array() = (other.array() - mean) * gain;
  }
}

Eigen::MatrixXd Stack(const std::vector<const LabelledContact*>& contacts,
                      const std::vector<int>& indices,
                      const std::vector<Feature>& features, int frames) {
  Eigen::MatrixXd rows(indices.size(), features.size() * frames);
  for (size_t i = 0; i < indices.size(); ++i) {
    rows.row(static_cast<Eigen::Index>(i)) =
        Flatten(*contacts[indices[i]], features, frames);
  }
  return rows;
}

// Classifies `fold` from its first `frames` frames.
absl::Status AnswerAt(const std::vector<const LabelledContact*>& contacts,
                      const std::vector<int>& fold,
                      const std::vector<int>& rest,
                      const std::vector<Feature>& features, int frames,
                      int classes, std::vector<Outcome>& outcomes) {
  Eigen::MatrixXd train = Stack(contacts, rest, features, frames);
  Eigen::MatrixXd test = Stack(contacts, fold, features, frames);
  Standardise(static_cast<int>(features.size()), frames, train, test);
  std::vector<int> labels;
  for (int i : rest) labels.push_back(outcomes[i].label);
  TACTUS_ASSIGN_OR_RETURN(const PcaNearest nearest,
                          PcaNearest::Fit(train, labels, kVarianceFraction));
  for (size_t i = 0; i < fold.size(); ++i) {
    TACTUS_ASSIGN_OR_RETURN(
        const PcaNearest::Match match,
        nearest.Predict(test.row(static_cast<Eigen::Index>(i)).transpose()));
    Outcome& outcome = outcomes[fold[i]];
    outcome.probability.assign(classes, 0);
    outcome.probability[match.label] = 1;
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status EvaluateNearestFold(
    const std::vector<const LabelledContact*>& contacts,
    const std::vector<int>& fold, const std::vector<Feature>& features,
    Evaluation& result) {
  const auto rest = Complement(fold, static_cast<int>(contacts.size()));
  const int classes = static_cast<int>(result.class_names.size());
  const auto frames = AnytimeFrames(contacts.front()->sample_rate_hz);
  for (int t = 0; t < kAnytimeCount; ++t) {
    TACTUS_RETURN_IF_ERROR(AnswerAt(contacts, fold, rest, features,
                                    static_cast<int>(frames[t]), classes,
                                    result.anytime[t]));
  }
  // The window ends with the longest of the times, as in the paper.
  for (int i : fold) result.final[i] = result.anytime.back()[i];
  return absl::OkStatus();
}

}  // namespace tactus::internal
