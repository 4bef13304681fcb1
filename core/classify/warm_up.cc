#include "core/classify/warm_up.h"

#include "core/base/status_macros.h"
#include "core/classify/contact_classifier.h"

namespace tactus::internal {

absl::Status AnswerWarmUp(Model& model) {
  model.warm_up.probability.assign(model.class_names.size(), 0);
  model.warm_up.log_likelihood = model.warm_up.probability;
  TACTUS_ASSIGN_OR_RETURN(auto compiled, CompiledModel::Create(model));
  ContactClassifier classifier(compiled, {});
  for (size_t i = 0; i < model.warm_up.samples.size(); ++i) {
    classifier.Step(compiled->model().warm_up.Sample(i), 0);
  }
  const auto probability = classifier.probability();
  const auto scores = classifier.log_likelihood();
  model.warm_up.probability.assign(probability.begin(), probability.end());
  model.warm_up.log_likelihood.assign(scores.begin(), scores.end());
  return absl::OkStatus();
}

}  // namespace tactus::internal
