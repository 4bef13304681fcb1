// File: compiled_model.h
//
// CompiledModel: a validated Model with its HMMs and LSTMs packed for scoring.
//
//   TACTUS_ASSIGN_OR_RETURN(auto model,
//   CompiledModel::Create(std::move(plain))); ContactClassifier
//   classifier(model, {});
//
// Immutable. Any number of streams and threads may share it as
// shared_ptr<const CompiledModel>. A stream keeps the model it started with.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "core/classify/model.h"
#include "core/hmm/hmm_bank.h"
#include "core/lstm/stepper.h"
#include "core/questions/decision_tracker.h"
#include "core/questions/question.h"

namespace tactus::internal {

class CompiledModel {
 public:
  // Fails as Validate(model) does. Does not run the warm-up trial.
  static absl::StatusOr<std::shared_ptr<const CompiledModel>> Create(
      Model model);

  const Model& model() const { return model_; }
  // What the classes answer: Model::questions, or DefaultQuestions() if the
  // model names none. At least one.
  const std::vector<Question>& questions() const { return questions_; }
  // When each question is decided.
  const std::vector<DecisionRule>& rules() const { return rules_; }
  // The HMMs of all classes; null for a model without HMMs.
  const HmmBank* hmms() const { return hmms_ ? &*hmms_ : nullptr; }
  // Empty without an LSTM.
  const std::vector<CompiledLstm>& lstms() const { return lstms_; }
  // Null without an estimate of the object.
  const CompiledLstm* estimator() const {
    return estimator_ ? &*estimator_ : nullptr;
  }

 private:
  explicit CompiledModel(Model model) : model_(std::move(model)) {}

  Model model_;
  std::vector<Question> questions_;
  std::vector<DecisionRule> rules_;
  std::optional<HmmBank> hmms_;
  std::vector<CompiledLstm> lstms_;
  std::optional<CompiledLstm> estimator_;
};

// OK if replaying the model's warm-up trial gives its stored answer; else
// INVALID_MODEL. The answer must agree to 1e-4 in every probability: HMMs are
// scored in float, and CPUs round its sums differently.
absl::Status RunWarmUp(const CompiledModel& model);

}  // namespace tactus::internal
