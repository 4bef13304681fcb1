#include "core/classify/compiled_model.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/classify/contact_classifier.h"

namespace tactus::internal {
namespace {

std::vector<DecisionRule> RulesOf(const Calibration& c,
                                  const std::vector<Question>& questions) {
  const bool own = !c.question_threshold.empty();
  std::vector<DecisionRule> rules;
  for (size_t q = 0; q < questions.size(); ++q) {
    rules.push_back({questions[q].kind,
                     own ? c.question_threshold[q] : c.decision_threshold,
                     own ? c.question_frames[q] : c.decision_frames});
  }
  return rules;
}

}  // namespace

absl::StatusOr<std::shared_ptr<const CompiledModel>> CompiledModel::Create(
    Model model) {
  TACTUS_RETURN_IF_ERROR(Validate(model));
  std::shared_ptr<CompiledModel> compiled(new CompiledModel(std::move(model)));
  const Model& m = compiled->model_;
  compiled->questions_ =
      m.questions.empty() ? DefaultQuestions(m.class_names) : m.questions;
  compiled->rules_ = RulesOf(m.calibration, compiled->questions_);
  if (HasHmms(m)) {
    TACTUS_ASSIGN_OR_RETURN(compiled->hmms_, HmmBank::Create(m.hmms));
  }
  for (const LstmNetwork& network : m.lstms) {
    TACTUS_ASSIGN_OR_RETURN(auto lstm, CompiledLstm::Create(network));
    compiled->lstms_.push_back(std::move(lstm));
  }
  if (m.estimator) {
    TACTUS_ASSIGN_OR_RETURN(compiled->estimator_,
                            CompiledLstm::Create(*m.estimator));
  }
  return std::shared_ptr<const CompiledModel>(std::move(compiled));
}

absl::Status RunWarmUp(const CompiledModel& model) {
  constexpr double kTolerance = 1e-4;
  const WarmUpTrial& trial = model.model().warm_up;
  if (trial.samples.empty()) return absl::OkStatus();
  // A pointer without ownership: the model outlives this call.
  ContactClassifier classifier(
      std::shared_ptr<const CompiledModel>(std::shared_ptr<void>(), &model),
      {});
  for (size_t i = 0; i < trial.samples.size(); ++i) {
    classifier.Step(trial.Sample(i), 0);
  }
  for (size_t k = 0; k < trial.probability.size(); ++k) {
    const double got = classifier.probability()[k];
    if (!(std::abs(got - trial.probability[k]) <= kTolerance)) {
      return InvalidModel(
          absl::StrCat("warm-up probability of ", model.model().class_names[k]),
          got, absl::StrCat(trial.probability[k], ", as stored"));
    }
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal
