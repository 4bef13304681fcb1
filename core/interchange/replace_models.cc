#include "core/interchange/replace_models.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

// Weight of the networks beside the HMMs until a calibration is fitted.
constexpr double kEvenWeight = 0.5;

bool Same(const ModelInput& a, const ModelInput& b) {
  return a.cue == b.cue && a.log_offset == b.log_offset &&
         a.offset == b.offset && a.gain == b.gain && a.limit == b.limit;
}

bool Same(const std::vector<ModelInput>& a, const std::vector<ModelInput>& b) {
  return std::equal(
      a.begin(), a.end(), b.begin(), b.end(),
      [](const ModelInput& x, const ModelInput& y) { return Same(x, y); });
}

absl::StatusOr<size_t> ClassIndex(const std::string& name, const Model& model) {
  const auto found = std::ranges::find(model.class_names, name);
  if (found != model.class_names.end()) {
    return static_cast<size_t>(found - model.class_names.begin());
  }
  return InvalidModel(
      "class", name.empty() ? "not named" : name,
      absl::StrCat("one of ", absl::StrJoin(model.class_names, ", ")));
}

absl::Status ReplaceHmms(const ForeignModel& foreign, Model& model) {
  if (!HasHmms(model)) {
    return InvalidModel("the model", "one without HMMs",
                        "one with HMMs, for others to replace them");
  }
  std::set<size_t> replaced;
  for (const NamedMixture& named : foreign.hmms) {
    TACTUS_ASSIGN_OR_RETURN(const size_t index,
                            ClassIndex(named.class_name, model));
    if (!replaced.insert(index).second) {
      return InvalidModel("class", named.class_name, "there once");
    }
    model.hmms[index] = named.mixture;
  }
  if (foreign.hmm_score) model.hmm_score = *foreign.hmm_score;
  const StepIntervals steps = foreign.steps.value_or(model.inputs.hmm_steps);
  const bool changed =
      (!foreign.inputs.empty() && !Same(foreign.inputs, model.inputs.hmm)) ||
      steps != model.inputs.hmm_steps;
  if (changed && replaced.size() != model.class_names.size()) {
    return InvalidModel("inputs", "other than the model's",
                        "the model's unless the HMMs of all classes are there");
  }
  if (!foreign.inputs.empty()) model.inputs.hmm = foreign.inputs;
  model.inputs.hmm_steps = steps;
  return absl::OkStatus();
}

// Puts the rows of the dense layer into the model's order of classes.
absl::Status OrderClasses(const std::vector<std::string>& names,
                          const Model& model, LstmNetwork& network) {
  const size_t features = network.features();
  const LstmNetwork from = network;
  std::set<size_t> seen;
  for (size_t k = 0; k < names.size(); ++k) {
    TACTUS_ASSIGN_OR_RETURN(const size_t index, ClassIndex(names[k], model));
    if (!seen.insert(index).second || index >= names.size()) {
      return InvalidModel("classes of the network", absl::StrJoin(names, ", "),
                          absl::StrJoin(model.class_names, ", "));
    }
    network.dense_bias[index] = from.dense_bias[k];
    std::copy_n(
        from.dense_kernel.begin() + static_cast<ptrdiff_t>(k * features),
        features,
        network.dense_kernel.begin() +
            static_cast<ptrdiff_t>(index * features));
  }
  return absl::OkStatus();
}

absl::Status ReplaceLstms(const ForeignModel& foreign, Model& model) {
  if (foreign.inputs.empty() && model.inputs.lstm.empty()) {
    return InvalidModel("inputs of the network", "not stated",
                        "in the file's metadata, or those of a bundle that has "
                        "LSTMs already");
  }
  const bool same_inputs =
      foreign.inputs.empty() || Same(foreign.inputs, model.inputs.lstm);
  const bool same_steps =
      !foreign.steps || *foreign.steps == model.inputs.lstm_steps;
  // It was trained on the earlier steps and inputs.
  if (!same_inputs || !same_steps) RemoveEstimator(model);
  if (!same_inputs) model.inputs.lstm = foreign.inputs;
  if (!same_steps) model.inputs.lstm_steps = *foreign.steps;
  if (model.lstms.empty()) {
    Calibration& c = model.calibration;
    c.hmm_weight.assign(c.frames.size(), kEvenWeight);
    c.lstm_weight = c.hmm_weight;
    c.lstm_inverse_temperature.assign(c.frames.size(), 1);
    c.lstm_bias.assign(c.frames.size() * c.prior.size(), 0);
    c.fused_bias = c.lstm_bias;
  }
  model.lstms = foreign.lstms;
  if (foreign.class_names.empty()) return absl::OkStatus();
  for (LstmNetwork& network : model.lstms) {
    TACTUS_RETURN_IF_ERROR(OrderClasses(foreign.class_names, model, network));
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status ReplaceModels(const ForeignModel& foreign, Model& model) {
  Model changed = model;
  const double rate = model.inputs.sample_rate_hz;
  if (foreign.sample_rate_hz != 0 && foreign.sample_rate_hz != rate) {
    return InvalidModel("sample_rate_hz", foreign.sample_rate_hz,
                        absl::StrCat(rate, ", as the model's"));
  }
  if (!foreign.hmms.empty()) {
    TACTUS_RETURN_IF_ERROR(ReplaceHmms(foreign, changed));
  }
  if (!foreign.lstms.empty()) {
    TACTUS_RETURN_IF_ERROR(ReplaceLstms(foreign, changed));
  }
  TACTUS_RETURN_IF_ERROR(Validate(changed));
  model = std::move(changed);
  return absl::OkStatus();
}

}  // namespace tactus::internal
