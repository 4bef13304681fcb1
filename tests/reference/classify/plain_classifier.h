// File: plain_classifier.h
//
// The answers of a Model about one contact in long double, written from the
// formulas of the headers in plain loops: cues, inputs, mixtures of HMMs by the
// forward algorithm in the domain of logarithms, LSTMs, calibration, `unknown`
// and the object estimate. Shares no code with ContactClassifier but plain data
// and what says when to step and look. The tests compare the two.
//
//   PlainClassifier plain(model);
//   plain.StepOrHold(frame);
//   plain.probability();
//
// For models scored by the forward algorithm that need no taxels. `model` must
// outlive it. Not thread-safe.
#pragma once

#include <cstdint>
#include <vector>

#include "core/classify/course_watch.h"
#include "core/classify/model.h"
#include "core/classify/object_estimate.h"
#include "core/classify/step_clock.h"
#include "core/questions/question.h"
#include "tests/reference/classify/plain_cues.h"

namespace tactus::internal {

class PlainClassifier {
 public:
  using Numbers = std::vector<long double>;

  explicit PlainClassifier(const Model& model);

  void Reset();
  void StepOrHold(const ContactFrame& frame);

  // One per class.
  const Numbers& log_likelihood() const { return log_likelihood_; }
  const Numbers& hmm_probability() const { return hmm_probability_; }
  const Numbers& lstm_probability() const { return lstm_probability_; }
  const Numbers& probability() const { return probability_; }
  long double unknown() const { return unknown_; }
  const std::optional<ObjectEstimate>& object() const { return object_; }

 private:
  // Output and cell of each layer.
  struct Memory {
    std::vector<Numbers> output;
    std::vector<Numbers> cell;
  };

  Numbers Inputs(const std::vector<ModelInput>& inputs) const;
  void StepHmms();
  void StepLstms();
  // On a copy of the networks' memories.
  void Look();
  Numbers ScoreOf(std::vector<Memory>& memories, const Numbers& x) const;
  bool LookIsDue(bool left_course) const;
  void UpdateProbabilities();
  void AgreeOnStates();
  // Outputs of the dense layer.
  static Numbers StepNetwork(const LstmNetwork& network, Numbers x,
                             Memory& memory);

  const Model* model_;
  PlainCues cues_;
  uint64_t frames_ = 0;
  uint64_t calibration_frame_ = 0;
  uint64_t hmm_steps_ = 0;
  StepClock hmm_clock_;
  StepClock lstm_clock_;
  CourseWatch watch_;
  const std::vector<Question> questions_;
  uint64_t evaluations_ = 0;
  uint64_t evaluated_frame_ = 0;
  bool evaluated_now_ = false;
  // [questions][values], of states: by the last evaluation, by the one before,
  // and what they agree on.
  std::vector<Numbers> last_;
  std::vector<Numbers> before_;
  std::vector<Numbers> agreed_;
  // [class][component][state]: log p(inputs so far, state).
  std::vector<std::vector<Numbers>> log_alpha_;
  std::vector<Memory> memories_;
  Memory estimator_memory_;
  Numbers log_likelihood_;
  Numbers lstm_score_;
  Numbers hmm_probability_;
  Numbers lstm_probability_;
  Numbers probability_;
  long double unknown_ = 0;
  bool answered_ = false;
  std::optional<ObjectEstimate> object_;
};

}  // namespace tactus::internal
