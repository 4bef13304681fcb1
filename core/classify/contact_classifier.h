// File: contact_classifier.h
//
// ContactClassifier: running class probabilities of one contact.
//
//   ContactClassifier classifier(model, {});
//   for (const ContactSample& sample : contact) classifier.Step(sample, 0);
//   classifier.probability();
//
// Scores the HMMs of every class with the incremental forward algorithm (or
// Viterbi), or what stands in their place, and steps the LSTMs, both at the
// model's intervals (step_clock.h). Between two steps, a look evaluates the
// LSTMs on a copy of their state, which is then forgotten: a model with a state
// question (question.h) takes one when the contact leaves its course
// (course_watch.h) and while a state is not sure. What it says of a state is
// what the last two evaluations agree on (consensus.h). Memory is constant;
// nothing allocates. Skips what skip_rules.h allows.
//
// Shares ownership of the model. Not thread-safe: one per stream.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/classify/calibration.h"
#include "core/classify/compiled_model.h"
#include "core/classify/course_watch.h"
#include "core/classify/input_spec.h"
#include "core/classify/object_estimate.h"
#include "core/classify/skip_rules.h"
#include "core/classify/step_savings.h"
#include "core/cues/cue_tracker.h"
#include "core/questions/decision_tracker.h"

namespace tactus::internal {

// A class whose probability stayed above the threshold for long enough.
struct Decision {
  int class_index = 0;
  // Frames since onset at which it was made, from 1.
  uint64_t frame = 0;
};

// Models that take part in the answer.
enum class Scorers {
  // HMMs and LSTMs fused; the HMMs alone if there is no LSTM. A ridge and
  // nearest neighbours count as
  // the HMMs, here and below.
  kAll,
  kHmms,
  // Needs LSTMs. Without HMMs no contact is unknown.
  kLstms,
};

class ContactClassifier {
 public:
  struct Options {
    // When the class and every question are decided; zero selects the model's
    // values.
    double decision_threshold = 0;
    uint32_t decision_frames = 0;
    // Which models answer; as if the model had no others.
    Scorers scorers = Scorers::kAll;
    // Steps of the LSTMs that are left out; none by default. If there are any,
    // no looks are taken.
    StepSavings savings = {};
    // Looks are taken if the model has a state question.
    bool looks = true;
  };

  ContactClassifier(std::shared_ptr<const CompiledModel> model,
                    const Options& options, const SkipRules& skip = {});

  // Forgets the contact.
  void Reset();

  // Takes the features of the next frame. `missing_before` frames were lost
  // directly before it. The HMMs predict across the steps that were due in them
  // (at most limits::kMaxBridgedFrames); the LSTMs do not take those steps, and
  // learners that see all taxels leave the frames out.
  void Step(const ContactSample& sample, uint64_t missing_before);

  // Takes a frame in which touch was lost: time passes, scores stay as they
  // are.
  void Hold(uint64_t missing_before) { frames_ += missing_before + 1; }

  // Step() if the frame is touched, else Hold().
  void StepOrHold(const ContactFrame& frame, uint64_t missing_before) {
    if (frame.touched) {
      Step(frame.sample, missing_before);
    } else {
      Hold(missing_before);
    }
  }

  // Frames since onset, lost and untouched ones included.
  uint64_t frames() const { return frames_; }
  // Steps of the HMMs so far.
  uint64_t hmm_steps() const { return hmm_steps_; }
  // What the best score is divided by before it is compared with those of
  // training: a log-likelihood grows with each step, other
  // scores do not.
  double evidence_steps() const {
    return hmms_ ? static_cast<double>(hmm_steps_) : 1;
  }
  // Steps of the LSTMs so far, and looks between them.
  uint64_t lstm_steps() const { return lstm_steps_; }
  uint64_t looks() const { return looks_; }
  // The scaled inputs of the last step of the HMMs and of the LSTMs, in the
  // order of InputSpec; of no meaning before the first.
  std::span<const double> hmm_input() const { return hmm_input_; }
  std::span<const double> lstm_input() const { return lstm_input_; }
  // One log p(HMM inputs | class) per class, or the scores of what
  // stands in place of HMMs.
  std::span<const double> log_likelihood() const { return log_likelihood_; }
  // Log of the LSTMs' mean probability before calibration at their last step
  // or look, one per class; empty unless LSTMs take part.
  std::span<const double> lstm_score() const { return lstm_score_; }
  // One probability per class; they sum to 1. The prior before the first frame.
  std::span<const double> probability() const { return probability_; }
  // Computed when it is read, unless the answer needs it.
  std::span<const double> hmm_probability() const {
    if (!hmm_probability_known_) UpdateHmmProbability();
    return hmm_probability_;
  }
  // Empty unless LSTMs take part.
  std::span<const double> lstm_probability() const { return lstm_probability_; }
  // The estimate of the object at the last step of the LSTMs. Nothing before
  // their first step, or without an estimator.
  const std::optional<ObjectEstimate>& object() const { return object_; }
  // Probability that training had nothing like this contact
  // (UnknownProbability).
  double unknown() const { return unknown_; }
  // Fraction of the last kStabilityWindow frames with the same best class.
  double stability() const;
  int best_class() const { return best_class_; }
  // False if no input is made from ContactSample::profile.
  bool uses_profile() const { return (sources_ & kFromProfile) != 0; }
  // False if no input is made from ContactSample::spread.
  bool uses_spread() const { return (sources_ & kFromSpread) != 0; }
  // False if no input is made from ContactSample::shear.
  bool uses_shear() const { return (sources_ & kFromShear) != 0; }
  // True if an input is made from ContactSample::loads, or there are
  // no HMMs.
  bool uses_taxels() const { return TaxelsNeeded(model_->model()) > 0; }
  // True if ContactSample::loads must have the components, too.
  bool uses_components() const { return NeedsComponents(model_->model()); }
  // Steps of the LSTMs that Options::savings left out, over all contacts.
  uint64_t saved_steps() const { return saved_steps_; }
  // Counts over all contacts; never reset.
  const SkipCounters& skipped() const { return skipped_; }
  // One probability per value of a question (CompiledModel::questions); they
  // sum to 1.
  std::span<const double> value_probability(size_t question) const {
    return value_probability_[question];
  }
  // One per question. EventAt(decision, frames()) is what the last frame did.
  std::span<const QuestionDecision> decisions() const {
    return tracker_.decisions();
  }
  // The decision on the class. Set once per contact; unchanged until Reset().
  const std::optional<Decision>& decision() const { return decision_; }

  static constexpr int kStabilityWindow = 16;
  // A state whose most probable value has less than this is looked at in every
  // frame.
  static constexpr double kSureState = 0.95;

 private:
  void MakeLstms();
  void StepHmms(const ContactSample& sample, uint64_t missing_before);
  // Steps the LSTMs if a step is due, or counts why the step was skipped.
  // Returns true if they were stepped.
  bool StepLstmsIfDue();
  // True if Options::savings leave out the step that is due.
  bool SavesStep();
  bool InputsChanged();
  void StepLstms();
  // Takes a look if one is due. `left_course` is what watch_ said.
  void LookIfDue(bool left_course);
  void ScoreLstms(std::span<const LstmStepper> lstms);
  void EstimateObject();
  void AgreeOnStates();
  void UpdateProbabilities();
  void UpdateHmmProbability() const;
  void AskHmmsFirst();
  void UpdateSettled();
  void UpdateDecision();
  void UpdateValues();
  void UpdateQuestions();

  std::shared_ptr<const CompiledModel> model_;
  Options options_;
  SkipRules skip_;
  SkipCounters skipped_;
  CueGroups groups_;
  CueSources sources_;

  CueTracker cues_;
  // One of the two.
  std::optional<BankFilter> hmms_;
  std::optional<RidgeScorer> ridge_;
  std::optional<NearestScorer> nearest_;
  std::optional<TreesScorer> trees_;
  // Empty if the LSTMs are never stepped.
  std::vector<LstmStepper> lstms_;
  std::optional<LstmStepper> estimator_;
  // One per LSTM; empty if no looks are taken.
  std::vector<LstmStepper> look_lstms_;
  CourseWatch watch_;

  std::vector<double> hmm_input_;
  std::vector<double> lstm_input_;
  std::vector<double> log_likelihood_;
  std::vector<double> log_prior_;
  // That of log_likelihood_ and calibration_point_, once it is known.
  mutable std::vector<double> hmm_probability_;
  mutable bool hmm_probability_known_ = true;
  // Log of the networks' mean probability; 0 before their first step.
  std::vector<double> lstm_score_;
  std::vector<double> lstm_probability_;
  std::vector<double> probability_;
  // [questions][values]
  std::vector<std::vector<double>> value_probability_;
  // One per state question, if looks are taken: its probabilities by the LSTMs'
  // last evaluation and by the one before.
  struct State {
    size_t question = 0;
    std::vector<double> last;
    std::vector<double> before;
  };
  std::vector<State> states_;
  // Evaluations of the LSTMs since onset, and the frame of the last.
  uint64_t evaluations_ = 0;
  uint64_t evaluated_frame_ = 0;
  bool evaluated_now_ = false;
  mutable std::vector<double> bias_;
  // The calibration that the probabilities were computed with.
  CalibrationPoint calibration_point_;
  // Since these were computed: a step of HMMs or LSTMs was due, and one was
  // taken.
  bool step_due_ = true;
  bool scores_changed_ = true;
  std::optional<ObjectEstimate> object_;
  double unknown_ = 0;

  StepClock hmm_clock_;
  StepClock lstm_clock_;
  uint64_t frames_ = 0;
  uint64_t scored_frames_ = 0;
  // Models take no more steps (Calibration::hold_after_frames).
  bool holds_ = false;
  uint64_t hmm_steps_ = 0;
  int best_class_ = 0;
  // Ring of the best classes of the last frames.
  std::vector<int> recent_best_;
  uint32_t frames_above_ = 0;
  // For Options::savings. LSTM steps in a row after which the answer was
  // settled_class_ with the wanted probability; steps left out since the last.
  uint64_t settled_steps_ = 0;
  int settled_class_ = 0;
  uint32_t left_out_ = 0;
  uint32_t unchanged_ = 0;
  uint64_t lstm_steps_ = 0;
  uint64_t looks_ = 0;
  bool hmms_are_sure_ = false;
  uint64_t saved_steps_ = 0;
  std::vector<double> next_input_;
  std::optional<Decision> decision_;
  DecisionTracker tracker_;
};

}  // namespace tactus::internal
