#include "core/classify/contact_classifier.h"

#include <algorithm>
#include <cmath>

#include "core/base/limits.h"
#include "core/classify/calibration.h"
#include "core/classify/feature_input.h"

namespace tactus {

ContactClassifier::ContactClassifier(std::shared_ptr<const CompiledModel> model,
                                     const Options& options)
    : model_(std::move(model)) {
  const Model& m = model_->model();
  const Calibration& c = m.calibration;
  decision_threshold_ = options.decision_threshold > 0
                            ? options.decision_threshold
                            : c.decision_threshold;
  decision_frames_ =
      options.decision_frames > 0 ? options.decision_frames : c.decision_frames;
  hmms_.reserve(model_->hmms().size());
  for (const CompiledMixture& mixture : model_->hmms()) {
    hmms_.emplace_back(mixture, m.hmm_score);
  }
  hmm_input_.resize(m.features.features.size());
  const size_t classes = m.class_names.size();
  log_likelihood_.resize(classes);
  hmm_probability_.resize(classes);
  probability_.resize(classes);
  log_prior_.resize(classes);
  std::transform(c.prior.begin(), c.prior.end(), log_prior_.begin(),
                 [](double p) { return std::log(p); });
  recent_best_.resize(kStabilityWindow);
  if (model_->lstm() != nullptr) {
    lstm_.emplace(*model_->lstm());
    lstm_input_.resize(m.features.features.size());
    lstm_probability_.resize(classes);
  }
  Reset();
}

void ContactClassifier::Reset() {
  const std::vector<double>& prior = model_->model().calibration.prior;
  for (MixtureFilter& filter : hmms_) filter.Reset();
  if (lstm_) lstm_->Reset();
  std::fill(log_likelihood_.begin(), log_likelihood_.end(), 0.0);
  std::copy(prior.begin(), prior.end(), hmm_probability_.begin());
  std::copy(prior.begin(), prior.end(), probability_.begin());
  if (lstm_) {
    std::copy(prior.begin(), prior.end(), lstm_probability_.begin());
  }
  unknown_ = 0;
  frames_ = 0;
  scored_frames_ = 0;
  best_class_ = static_cast<int>(std::max_element(prior.begin(), prior.end()) -
                                 prior.begin());
  frames_above_ = 0;
  decision_.reset();
}

void ContactClassifier::Step(const FeatureVector& features,
                             uint64_t missing_before) {
  const Model& m = model_->model();
  const int bridged = static_cast<int>(
      std::min<uint64_t>(missing_before, limits::kMaxBridgedFrames));
  frames_ += missing_before + 1;
  ++scored_frames_;

  MakeInput(m.features, m.features.hmm_scaling, features, hmm_input_);
  for (size_t k = 0; k < hmms_.size(); ++k) {
    if (bridged > 0) hmms_[k].Skip(bridged);
    hmms_[k].Step(hmm_input_);
    log_likelihood_[k] = hmms_[k].log_likelihood();
  }
  if (lstm_) {
    MakeInput(m.features, m.features.lstm_scaling, features, lstm_input_);
    for (int i = 0; i <= bridged; ++i) lstm_->Step(lstm_input_);
  }
  UpdateProbabilities();
  UpdateDecision();
}

void ContactClassifier::UpdateProbabilities() {
  const CalibrationPoint point =
      CalibrationAt(model_->model().calibration, static_cast<double>(frames_));
  TemperedPosterior(log_prior_, log_likelihood_, point.hmm_temperature,
                    hmm_probability_);
  if (lstm_) {
    TemperedPosterior(log_prior_, lstm_->log_probability(),
                      point.lstm_temperature, lstm_probability_);
    FusePosteriors(hmm_probability_, lstm_probability_, point.lstm_weight,
                   probability_);
  } else {
    std::copy(hmm_probability_.begin(), hmm_probability_.end(),
              probability_.begin());
  }
  const double best =
      *std::max_element(log_likelihood_.begin(), log_likelihood_.end());
  unknown_ = UnknownShare(point, best / static_cast<double>(scored_frames_));
}

void ContactClassifier::UpdateDecision() {
  const auto best = std::max_element(probability_.begin(), probability_.end());
  const int best_class = static_cast<int>(best - probability_.begin());
  recent_best_[(scored_frames_ - 1) % kStabilityWindow] = best_class;
  // The class that no model explains is not a decision for any other.
  const bool above = *best >= decision_threshold_ && unknown_ < 0.5;
  const bool same = best_class == best_class_ && frames_above_ > 0;
  frames_above_ = above ? (same ? frames_above_ + 1 : 1) : 0;
  best_class_ = best_class;
  if (!decision_ && frames_above_ >= decision_frames_) {
    decision_ = Decision{best_class, frames_};
  }
}

double ContactClassifier::stability() const {
  const auto count = std::min<uint64_t>(scored_frames_, kStabilityWindow);
  if (count == 0) return 0;
  const auto same = std::count(
      recent_best_.begin(),
      recent_best_.begin() + static_cast<ptrdiff_t>(count), best_class_);
  return static_cast<double>(same) / static_cast<double>(count);
}

}  // namespace tactus
