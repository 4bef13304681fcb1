#include "core/classify/contact_classifier.h"

#include <algorithm>
#include <cmath>

#include "core/base/limits.h"
#include "core/questions/consensus.h"

namespace tactus::internal {
namespace {

// Frames from an evaluation of the LSTMs to a look at a new course: one frame
// more shows more of it than the next one.
constexpr uint64_t kCourseFrames = 2;

// The model's rules, or one threshold and one number of frames for all of them
// where the options give some.
std::vector<DecisionRule> RulesFor(const CompiledModel& model,
                                   const ContactClassifier::Options& options) {
  std::vector<DecisionRule> rules = model.rules();
  for (DecisionRule& rule : rules) {
    if (options.decision_threshold > 0) {
      rule.threshold = options.decision_threshold;
    }
    if (options.decision_frames > 0) rule.frames = options.decision_frames;
  }
  return rules;
}

ContactClassifier::Options FillIn(ContactClassifier::Options options,
                                  const Calibration& calibration) {
  if (options.decision_threshold <= 0) {
    options.decision_threshold = calibration.decision_threshold;
  }
  if (options.decision_frames == 0) {
    options.decision_frames = calibration.decision_frames;
  }
  return options;
}

CueGroups GroupsFor(const InputSpec& spec,
                    const ContactClassifier::Options& options,
                    const SkipRules& skip) {
  if (!skip[SkipRule::kUnusedCues]) return kAllCueGroups;
  return CuesNeeded(
      spec, options.scorers != Scorers::kHmms || !skip[SkipRule::kUnusedLstms]);
}

}  // namespace

ContactClassifier::ContactClassifier(std::shared_ptr<const CompiledModel> model,
                                     const Options& options,
                                     const SkipRules& skip)
    : model_(std::move(model)),
      options_(FillIn(options, model_->model().calibration)),
      skip_(skip),
      groups_(GroupsFor(model_->model().inputs, options, skip)),
      sources_(SourcesOf(groups_)),
      cues_(model_->model().inputs.sample_rate_hz, groups_,
            &model_->model().inputs.embedding),
      hmm_clock_(model_->model().inputs.hmm_steps),
      lstm_clock_(model_->model().inputs.lstm_steps),
      tracker_(RulesFor(*model_, options)) {
  const Model& m = model_->model();
  const Calibration& c = m.calibration;
  skipped_[SkipRule::kUnusedCues] = CountUnused(groups_);
  if (m.ridge) {
    ridge_.emplace(&*m.ridge);
  } else if (m.nearest) {
    nearest_.emplace(&*m.nearest);
  } else if (m.trees) {
    trees_.emplace(&*m.trees);
  } else {
    hmms_.emplace(*model_->hmms(), m.hmm_score);
  }
  hmm_input_.resize(m.inputs.hmm.size());
  const size_t classes = m.class_names.size();
  log_likelihood_.resize(classes);
  hmm_probability_.resize(classes);
  probability_.resize(classes);
  for (const Question& question : model_->questions()) {
    value_probability_.emplace_back(question.values.size());
  }
  bias_.resize(classes);
  log_prior_.resize(classes);
  std::transform(c.prior.begin(), c.prior.end(), log_prior_.begin(),
                 [](double p) { return std::log(p); });
  recent_best_.resize(kStabilityWindow);
  MakeLstms();
  Reset();
}

void ContactClassifier::MakeLstms() {
  const Model& m = model_->model();
  if (m.lstms.empty()) return;
  if (options_.scorers != Scorers::kHmms) {
    lstm_score_.resize(m.class_names.size());
    lstm_probability_.resize(m.class_names.size());
    if (model_->estimator() != nullptr) {
      estimator_.emplace(*model_->estimator());
    }
  } else if (skip_[SkipRule::kUnusedLstms]) {
    return;
  }
  lstm_input_.resize(m.inputs.lstm.size());
  next_input_.resize(m.inputs.lstm.size());
  for (const CompiledLstm& lstm : model_->lstms()) lstms_.emplace_back(lstm);
  if (!options_.looks || options_.savings.any() || lstm_score_.empty()) return;
  const std::vector<Question>& questions = model_->questions();
  for (size_t q = 0; q < questions.size(); ++q) {
    if (questions[q].kind != Question::kState) continue;
    const std::vector<double> none(questions[q].values.size());
    states_.push_back({q, none, none});
  }
  if (!states_.empty()) look_lstms_ = lstms_;
}

void ContactClassifier::Reset() {
  const Model& m = model_->model();
  const std::vector<double>& prior = m.calibration.prior;
  cues_.Reset();
  if (hmms_) hmms_->Reset();
  if (ridge_) ridge_->Reset();
  if (nearest_) nearest_->Reset();
  if (trees_) trees_->Reset();
  for (LstmStepper& lstm : lstms_) lstm.Reset();
  if (estimator_) estimator_->Reset();
  std::fill(log_likelihood_.begin(), log_likelihood_.end(), 0.0);
  std::copy(prior.begin(), prior.end(), hmm_probability_.begin());
  hmm_probability_known_ = true;
  std::copy(prior.begin(), prior.end(), probability_.begin());
  UpdateValues();
  if (!lstm_score_.empty()) {
    std::copy(prior.begin(), prior.end(), lstm_probability_.begin());
    std::fill(lstm_score_.begin(), lstm_score_.end(), 0.0);
  }
  step_due_ = true;
  scores_changed_ = true;
  hmm_clock_.Reset();
  lstm_clock_.Reset();
  object_.reset();
  unknown_ = 0;
  frames_ = 0;
  holds_ = false;
  scored_frames_ = 0;
  hmm_steps_ = 0;
  best_class_ = static_cast<int>(std::max_element(prior.begin(), prior.end()) -
                                 prior.begin());
  frames_above_ = 0;
  decision_.reset();
  tracker_.Reset();
  settled_steps_ = 0;
  left_out_ = 0;
  unchanged_ = 0;
  lstm_steps_ = 0;
  looks_ = 0;
  evaluations_ = 0;
  evaluated_frame_ = 0;
  watch_.Reset();
  hmms_are_sure_ = false;
}

void ContactClassifier::Step(const ContactSample& sample,
                             uint64_t missing_before) {
  frames_ += missing_before + 1;
  ++scored_frames_;
  const uint32_t hold_after = model_->model().calibration.hold_after_frames;
  holds_ = hold_after > 0 && frames_ > hold_after;
  cues_.Step(sample, frames_);
  StepHmms(sample, missing_before);
  evaluated_now_ = false;
  const bool left_course =
      !look_lstms_.empty() && !holds_ && watch_.Step(sample);
  const bool stepped = StepLstmsIfDue();
  if (!stepped && !holds_) LookIfDue(left_course);
  UpdateProbabilities();
  if (stepped) UpdateSettled();
  UpdateDecision();
  UpdateQuestions();
}

void ContactClassifier::StepHmms(const ContactSample& sample,
                                 uint64_t missing_before) {
  if (options_.scorers == Scorers::kLstms || holds_) return;
  const int skipped = hmm_clock_.SkipMissing(frames_, missing_before,
                                             limits::kMaxBridgedFrames);
  if (hmms_) hmms_->Skip(skipped);
  if (ridge_) ridge_->Step(sample.loads);
  if (nearest_) nearest_->Step(sample.loads);
  if (trees_) trees_->Step(sample.loads);
  if (!hmm_clock_.Tick(frames_)) return;
  ++hmm_steps_;
  step_due_ = true;
  scores_changed_ = true;
  if (ridge_) {
    ridge_->Score(log_likelihood_);
  } else if (nearest_) {
    nearest_->Score(log_likelihood_);
  } else if (trees_) {
    trees_->Score(log_likelihood_);
  } else {
    MakeInput(model_->model().inputs.hmm, cues_, hmm_input_);
    hmms_->Step(hmm_input_);
    hmms_->LogLikelihood(log_likelihood_);
  }
}

bool ContactClassifier::StepLstmsIfDue() {
  const Model& m = model_->model();
  if (m.lstms.empty() || holds_ || !lstm_clock_.Tick(frames_)) return false;
  // Whether the step is taken or left out.
  step_due_ = true;
  if (lstms_.empty()) {
    ++skipped_[SkipRule::kUnusedLstms];
  } else if (options_.savings.any() && SavesStep()) {
    ++saved_steps_;
  } else {
    MakeInput(m.inputs.lstm, cues_, lstm_input_);
    StepLstms();
    return true;
  }
  return false;
}

bool ContactClassifier::SavesStep() {
  const StepSavings& s = options_.savings;
  if (hmms_are_sure_) return true;
  if (settled_steps_ >= s.settled_steps &&
      (s.settled_stride == 0 || left_out_ + 1 < s.settled_stride)) {
    ++left_out_;
    return true;
  }
  left_out_ = 0;
  if (s.unchanged_input > 0 && lstm_steps_ > 0 &&
      unchanged_ < s.most_unchanged && !InputsChanged()) {
    ++unchanged_;
    return true;
  }
  unchanged_ = 0;
  return false;
}

bool ContactClassifier::InputsChanged() {
  MakeInput(model_->model().inputs.lstm, cues_, next_input_);
  for (size_t i = 0; i < next_input_.size(); ++i) {
    if (!(std::abs(next_input_[i] - lstm_input_[i]) <
          options_.savings.unchanged_input)) {
      return true;
    }
  }
  return false;
}

void ContactClassifier::StepLstms() {
  ++lstm_steps_;
  for (LstmStepper& lstm : lstms_) lstm.Step(lstm_input_);
  ScoreLstms(lstms_);
  if (estimator_) EstimateObject();
}

void ContactClassifier::LookIfDue(bool left_course) {
  if (look_lstms_.empty() || lstm_steps_ == 0) return;
  const auto sure = [&](const State& state) {
    return *std::ranges::max_element(value_probability_[state.question]) >=
           kSureState;
  };
  const bool new_course =
      left_course && frames_ >= evaluated_frame_ + kCourseFrames;
  if (!new_course && std::ranges::all_of(states_, sure)) return;
  ++looks_;
  MakeInput(model_->model().inputs.lstm, cues_, next_input_);
  for (size_t i = 0; i < lstms_.size(); ++i) {
    look_lstms_[i] = lstms_[i];
    look_lstms_[i].Step(next_input_);
  }
  ScoreLstms(look_lstms_);
}

void ContactClassifier::ScoreLstms(std::span<const LstmStepper> lstms) {
  scores_changed_ = true;
  evaluated_now_ = true;
  evaluated_frame_ = frames_;
  watch_.Restart();
  const double weight = 1 / static_cast<double>(lstms.size());
  for (size_t k = 0; k < lstm_score_.size(); ++k) {
    double mean = 0;
    for (const LstmStepper& lstm : lstms) {
      mean += weight * lstm.probability()[k];
    }
    lstm_score_[k] = std::log(mean);
  }
}

void ContactClassifier::EstimateObject() {
  estimator_->Step(lstm_input_);
  const Calibration& c = model_->model().calibration;
  const auto log_variance = estimator_->regression_log_variance();
  // Limited, so that no weights make it infinite.
  const auto deviation_of = [](double log_variance) {
    return std::exp(0.5 * std::clamp(log_variance, -limits::kMaxLogVariance,
                                     limits::kMaxLogVariance));
  };
  const double deviation[] = {
      c.stiffness_deviation_scale * deviation_of(log_variance[0]),
      c.moved_deviation_scale * deviation_of(log_variance[1])};
  object_ = DecodeEstimate(estimator_->regression_mean().data(), deviation,
                           cues_.value(Cue::kMotion));
}

void ContactClassifier::UpdateProbabilities() {
  const Calibration& c = model_->model().calibration;
  const CalibrationPoint point =
      c.held && !step_due_ ? calibration_point_
                           : CalibrationAt(c, static_cast<double>(frames_));
  step_due_ = false;
  if (!scores_changed_ && point == calibration_point_ &&
      skip_[SkipRule::kUnchangedScores]) {
    ++skipped_[SkipRule::kUnchangedScores];
    return;
  }
  scores_changed_ = false;
  calibration_point_ = point;
  hmm_probability_known_ = false;
  if (lstm_score_.empty()) {
    std::ranges::copy(hmm_probability(), probability_.begin());
  } else {
    BiasAt(c.lstm_bias, point, bias_);
    TemperedPosterior(log_prior_, lstm_score_, point.lstm_inverse_temperature,
                      bias_, lstm_probability_);
    if (options_.scorers == Scorers::kLstms) {
      std::ranges::copy(lstm_probability_, probability_.begin());
    } else {
      if (point.hmm_weight != 0) UpdateHmmProbability();
      BiasAt(c.fused_bias, point, bias_);
      FusePosteriors(hmm_probability_, lstm_probability_, point, bias_,
                     probability_);
      AskHmmsFirst();
    }
  }
  UpdateValues();
  AgreeOnStates();
  if (hmm_steps_ == 0) return;
  const double best =
      *std::max_element(log_likelihood_.begin(), log_likelihood_.end());
  unknown_ = UnknownProbability(
      point, best / evidence_steps(),
      object_ ? std::optional(object_->log10_stiffness) : std::nullopt);
}

void ContactClassifier::AgreeOnStates() {
  evaluations_ += evaluated_now_;
  for (State& state : states_) {
    if (evaluated_now_) state.before.swap(state.last);
    std::ranges::copy(value_probability_[state.question], state.last.begin());
  }
  if (evaluations_ == 0) return;
  for (const State& state : states_) {
    std::vector<double>& agreed = value_probability_[state.question];
    Consensus(evaluations_ > 1 ? std::span<const double>(state.before)
                               : std::span<const double>(),
              agreed);
    SetValueProbability(model_->questions()[state.question], agreed,
                        probability_);
    UpdateValues();
  }
}

void ContactClassifier::AskHmmsFirst() {
  const double sure = options_.savings.sure_hmm_probability;
  if (sure > 1 || hmm_steps_ == 0) return;
  hmms_are_sure_ = *std::ranges::max_element(hmm_probability()) >= sure;
  if (hmms_are_sure_) {
    std::ranges::copy(hmm_probability_, probability_.begin());
  }
}

void ContactClassifier::UpdateHmmProbability() const {
  BiasAt(model_->model().calibration.hmm_bias, calibration_point_, bias_);
  TemperedPosterior(log_prior_, log_likelihood_,
                    calibration_point_.hmm_inverse_temperature, bias_,
                    hmm_probability_);
  hmm_probability_known_ = true;
}

void ContactClassifier::UpdateSettled() {
  const auto best = std::max_element(probability_.begin(), probability_.end());
  const int best_class = static_cast<int>(best - probability_.begin());
  if (*best < options_.savings.settled_probability) {
    settled_steps_ = 0;
  } else {
    settled_steps_ = best_class == settled_class_ ? settled_steps_ + 1 : 1;
    settled_class_ = best_class;
  }
}

void ContactClassifier::UpdateDecision() {
  const auto best = std::max_element(probability_.begin(), probability_.end());
  const int best_class = static_cast<int>(best - probability_.begin());
  recent_best_[(scored_frames_ - 1) % kStabilityWindow] = best_class;
  // An unknown contact is not decided.
  const bool above = *best >= options_.decision_threshold &&
                     unknown_ < DecisionTracker::kUnknown;
  const bool same = best_class == best_class_ && frames_above_ > 0;
  frames_above_ = above ? (same ? frames_above_ + 1 : 1) : 0;
  best_class_ = best_class;
  if (!decision_ && frames_above_ >= options_.decision_frames) {
    decision_ = Decision{best_class, frames_};
  }
}

void ContactClassifier::UpdateValues() {
  const std::vector<Question>& questions = model_->questions();
  for (size_t q = 0; q < questions.size(); ++q) {
    ValueProbability(questions[q], probability_, value_probability_[q]);
  }
}

void ContactClassifier::UpdateQuestions() {
  for (size_t q = 0; q < value_probability_.size(); ++q) {
    tracker_.Step(q, value_probability_[q], unknown_, frames_);
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

}  // namespace tactus::internal
