#include "core/classify/compiled_model.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/classify/calibration.h"
#include "core/classify/contact_classifier.h"
#include "core/classify/input_spec.h"
#include "core/classify/object_estimate.h"

namespace tactus {
namespace {

absl::Status CheckClassNames(const std::vector<std::string>& names) {
  if (names.size() < 2 || names.size() > limits::kMaxClasses) {
    return InvalidModel("number of classes", names.size(),
                        absl::StrCat("2 to ", limits::kMaxClasses));
  }
  std::set<std::string> seen;
  for (const std::string& name : names) {
    if (name.empty() || !seen.insert(name).second) {
      return InvalidModel("class name", absl::StrCat("\"", name, "\""),
                          "not empty and unique");
    }
  }
  return absl::OkStatus();
}

absl::Status CheckWarmUp(const Model& model) {
  const WarmUpTrial& trial = model.warm_up;
  if (trial.samples.empty()) return absl::OkStatus();
  for (const auto* answer : {&trial.probability, &trial.log_likelihood}) {
    if (answer->size() != model.class_names.size()) {
      return InvalidModel("warm_up answer size", answer->size(),
                          absl::StrCat(model.classes()));
    }
  }
  for (const ContactSample& sample : trial.samples) {
    for (double value : {sample.features[0], sample.features[1],
                         sample.features[2], sample.net_force}) {
      if (!std::isfinite(value)) {
        return InvalidModel("warm_up.signals", value, "finite");
      }
    }
    for (double value : sample.profile) {
      if (!std::isfinite(value)) {
        return InvalidModel("warm_up.profile", value, "finite");
      }
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<CompiledLstm> CompileNetwork(const LstmNetwork& network,
                                            int inputs, int classes,
                                            int regressions) {
  if (network.inputs() != inputs || network.classes() != classes ||
      network.regressions != regressions) {
    return InvalidModel(
        "LSTM inputs, classes and regressions",
        absl::StrCat(network.inputs(), ", ", network.classes(), " and ",
                     network.regressions),
        absl::StrCat(inputs, ", ", classes, " and ", regressions));
  }
  return CompiledLstm::Create(network);
}

}  // namespace

absl::StatusOr<std::shared_ptr<const CompiledModel>> CompiledModel::Create(
    Model model) {
  const bool has_lstm = !model.lstms.empty();
  if (model.estimator && !has_lstm) {
    return InvalidModel("estimator", "alone", "beside LSTMs");
  }
  TACTUS_RETURN_IF_ERROR(CheckClassNames(model.class_names));
  TACTUS_RETURN_IF_ERROR(Validate(model.inputs, has_lstm));
  TACTUS_RETURN_IF_ERROR(
      Validate(model.calibration, model.classes(), has_lstm));
  TACTUS_RETURN_IF_ERROR(CheckWarmUp(model));
  if (!model.layout.name.empty()) {
    TACTUS_RETURN_IF_ERROR(Validate(model.layout));
  }
  if (model.hmms.size() != model.class_names.size()) {
    return InvalidModel("number of HMM mixtures", model.hmms.size(),
                        absl::StrCat(model.classes(), ", one a class"));
  }

  std::shared_ptr<CompiledModel> compiled(new CompiledModel(std::move(model)));
  const Model& m = compiled->model_;
  const int inputs = static_cast<int>(m.inputs.hmm.size());
  TACTUS_ASSIGN_OR_RETURN(compiled->hmms_, HmmBank::Create(m.hmms));
  if (compiled->hmms_->dimensions() != inputs) {
    return InvalidModel("HMM dimensions", compiled->hmms_->dimensions(),
                        absl::StrCat(inputs, ", the number of HMM inputs"));
  }
  if (m.lstms.size() > limits::kMaxLstms) {
    return InvalidModel("number of LSTMs", m.lstms.size(),
                        absl::StrCat("at most ", limits::kMaxLstms));
  }
  const int lstm_inputs = static_cast<int>(m.inputs.lstm.size());
  for (const LstmNetwork& network : m.lstms) {
    TACTUS_ASSIGN_OR_RETURN(
        auto lstm, CompileNetwork(network, lstm_inputs, m.classes(), 0));
    compiled->lstms_.push_back(std::move(lstm));
  }
  if (m.estimator) {
    TACTUS_ASSIGN_OR_RETURN(compiled->estimator_,
                            CompileNetwork(*m.estimator, lstm_inputs,
                                           m.classes(), kEstimateRegressions));
  }
  return std::shared_ptr<const CompiledModel>(std::move(compiled));
}

absl::Status RunWarmUp(const CompiledModel& model) {
  constexpr double kTolerance = 1e-4;
  const WarmUpTrial& trial = model.model().warm_up;
  // A pointer without ownership: the model outlives this call.
  ContactClassifier classifier(
      std::shared_ptr<const CompiledModel>(std::shared_ptr<void>(), &model),
      {});
  for (const ContactSample& sample : trial.samples) {
    classifier.Step(sample, 0);
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

}  // namespace tactus
