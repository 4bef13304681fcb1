#include "core/classify/model.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/sha256.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/classify/calibration.h"
#include "core/classify/input_spec.h"
#include "core/classify/object_estimate.h"

namespace tactus::internal {
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
    if (!TextFault(name, limits::kMaxTrialTextBytes).empty()) {
      return InvalidModel("class name", absl::StrCat("\"", name, "\""),
                          absl::StrCat("UTF-8 without control characters, at "
                                       "most ",
                                       limits::kMaxTrialTextBytes, " bytes"));
    }
  }
  return absl::OkStatus();
}

absl::Status CheckQuestions(const Model& model) {
  const size_t questions = model.questions.size();
  if (questions > 0) {
    TACTUS_RETURN_IF_ERROR(Validate(std::span<const Question>(model.questions),
                                    model.class_names.size()));
  }
  const Calibration& c = model.calibration;
  if (c.question_threshold.size() != c.question_frames.size() ||
      (!c.question_threshold.empty() &&
       c.question_threshold.size() != questions)) {
    return InvalidModel(
        "calibration.question_threshold and question_frames size",
        absl::StrCat(c.question_threshold.size(), " and ",
                     c.question_frames.size()),
        absl::StrCat("both 0, or both ", questions, ", one per question"));
  }
  return absl::OkStatus();
}

bool SeesComponents(const FrameViews& views) {
  return views.planes > 0 || views.auxiliary() > 0;
}

// A ridge, nearest neighbours or trees, `name`, of so many classes and of this
// skin.
absl::Status CheckFromTaxels(absl::string_view name, int classes,
                             const FrameViews& views, const Model& model) {
  if (!model.hmms.empty() || !model.inputs.hmm.empty()) {
    return InvalidModel(
        "HMMs and their inputs",
        absl::StrCat(model.hmms.size(), " and ", model.inputs.hmm.size()),
        absl::StrCat("none beside ", name));
  }
  if (classes != model.classes() || views.rows != model.layout.rows ||
      views.columns != model.layout.columns) {
    return InvalidModel(
        absl::StrCat("classes, rows and columns of ", name),
        absl::StrCat(classes, ", ", views.rows, " and ", views.columns),
        absl::StrCat(model.classes(), ", ", model.layout.rows, " and ",
                     model.layout.columns));
  }
  const TaxelShape shape = ShapeOf(model.layout);
  if (!SeesComponents(views) || views.shape() == shape) return absl::OkStatus();
  return InvalidModel(
      absl::StrCat("planes and auxiliary components of ", name),
      absl::StrCat(views.planes, " and ", views.auxiliary()),
      absl::StrCat(shape.planes, " and ", shape.auxiliary, ", or none"));
}

absl::Status CheckHmms(const Model& model) {
  if (model.ridge.has_value() + model.nearest.has_value() +
          model.trees.has_value() >
      1) {
    return InvalidModel("ridge, nearest neighbours and trees", "several",
                        "one of them");
  }
  if (model.ridge) {
    TACTUS_RETURN_IF_ERROR(Validate(*model.ridge));
    return CheckFromTaxels("a ridge", model.ridge->classes(),
                           model.ridge->history, model);
  }
  if (model.nearest) {
    TACTUS_RETURN_IF_ERROR(Validate(*model.nearest));
    return CheckFromTaxels("nearest neighbours", model.nearest->classes,
                           model.nearest->views, model);
  }
  if (model.trees) {
    TACTUS_RETURN_IF_ERROR(Validate(*model.trees));
    return CheckFromTaxels("trees", model.trees->classes, model.trees->history,
                           model);
  }
  if (model.hmms.size() != model.class_names.size()) {
    return InvalidModel("number of HMM mixtures", model.hmms.size(),
                        absl::StrCat(model.classes(), ", one per class"));
  }
  const size_t inputs = model.inputs.hmm.size();
  for (const HmmMixture& mixture : model.hmms) {
    TACTUS_RETURN_IF_ERROR(Validate(mixture));
    const int dimensions = mixture.components.front().dimensions;
    if (static_cast<size_t>(dimensions) != inputs) {
      return InvalidModel("HMM dimensions", dimensions,
                          absl::StrCat(inputs, ", the number of HMM inputs"));
    }
  }
  return absl::OkStatus();
}

absl::Status CheckNetwork(const LstmNetwork& network, const Model& model,
                          int regressions) {
  TACTUS_RETURN_IF_ERROR(Validate(network));
  const int inputs = static_cast<int>(model.inputs.lstm.size());
  if (network.inputs() != inputs || network.classes() != model.classes() ||
      network.regressions != regressions) {
    return InvalidModel(
        "LSTM inputs, classes and regressions",
        absl::StrCat(network.inputs(), ", ", network.classes(), " and ",
                     network.regressions),
        absl::StrCat(inputs, ", ", model.classes(), " and ", regressions));
  }
  return absl::OkStatus();
}

absl::Status CheckLstms(const Model& model) {
  if (model.estimator && model.lstms.empty()) {
    return InvalidModel("estimator", "alone", "beside LSTMs");
  }
  if (model.lstms.size() > limits::kMaxLstms) {
    return InvalidModel("number of LSTMs", model.lstms.size(),
                        absl::StrCat("at most ", limits::kMaxLstms));
  }
  for (const LstmNetwork& network : model.lstms) {
    TACTUS_RETURN_IF_ERROR(CheckNetwork(network, model, 0));
  }
  if (!model.estimator) {
    const size_t entries = model.calibration.softest.size();
    if (entries == 0) return absl::OkStatus();
    return InvalidModel("calibration.softest size", entries,
                        "0 without an estimator");
  }
  return CheckNetwork(*model.estimator, model, kEstimateRegressions);
}

absl::Status CheckLayout(const SkinLayout& layout) {
  if (layout.name.empty()) return absl::OkStatus();
  const std::string fault = TextFault(layout.name, limits::kMaxNameBytes);
  if (!fault.empty()) {
    return InvalidModel("layout name", layout.name,
                        absl::StrCat("plain text: it ", fault));
  }
  return Validate(layout);
}

absl::Status CheckRelease(double release_after_s) {
  constexpr double kMost = limits::kMaxReleaseAfterMs / 1e3;
  // Written so that a NaN fails.
  if (std::isfinite(release_after_s) && release_after_s != 0 &&
      release_after_s <= kMost) {
    return absl::OkStatus();
  }
  return InvalidModel(
      "release_after_s", release_after_s,
      absl::StrCat("above 0 and at most ", kMost, ", or below 0 for never"));
}

absl::Status CheckProvenance(const Provenance& provenance) {
  for (const std::string* text : {&provenance.command, &provenance.version,
                                  &provenance.data, &provenance.note}) {
    if (text->size() > limits::kMaxProvenanceBytes || !IsUtf8(*text)) {
      return InvalidModel("provenance",
                          absl::StrCat(text->size(), " bytes of text"),
                          absl::StrCat("UTF-8 of at most ",
                                       limits::kMaxProvenanceBytes, " bytes"));
    }
  }
  if (provenance.trial_fingerprints.size() > limits::kMaxProvenanceTrials) {
    return InvalidModel("trial_fingerprints of the provenance",
                        provenance.trial_fingerprints.size(),
                        absl::StrCat("at most ", limits::kMaxProvenanceTrials));
  }
  if (!std::ranges::is_sorted(provenance.trial_fingerprints)) {
    return InvalidModel("trial_fingerprints of the provenance", "not sorted",
                        "rising");
  }
  if (!provenance.data_sha256.empty() && !IsSha256Hex(provenance.data_sha256)) {
    return InvalidModel("data_sha256 of the provenance",
                        Quoted(provenance.data_sha256),
                        "64 hexadecimal digits, or empty");
  }
  return absl::OkStatus();
}

absl::Status CheckWarmUpAnswer(absl::string_view name,
                               const std::vector<double>& answer,
                               const Model& model) {
  // A trial without frames may leave its answers out.
  const bool absent = answer.empty() && model.warm_up.samples.empty();
  if (!absent && answer.size() != model.class_names.size()) {
    return InvalidModel(absl::StrCat("warm_up.", name, " size"), answer.size(),
                        absl::StrCat(model.classes(), ", one per class"));
  }
  for (const double value : answer) {
    if (!std::isfinite(value)) {
      return InvalidModel(absl::StrCat("warm_up.", name), value, "finite");
    }
  }
  return absl::OkStatus();
}

// The taxels of the warm-up trial.
absl::Status CheckLoads(const Model& model) {
  const WarmUpTrial& trial = model.warm_up;
  const int taxels = NeedsComponents(model) ? ShapeOf(model.layout).total()
                                            : TaxelsNeeded(model);
  const size_t ends = taxels > 0 ? trial.samples.size() : 0;
  if (trial.load_ends.size() != ends) {
    return InvalidModel("warm_up.load_ends size", trial.load_ends.size(),
                        absl::StrCat(ends));
  }
  const size_t loads = ends == 0 ? 0 : trial.load_ends.back();
  if (trial.loads.size() != loads || !std::ranges::is_sorted(trial.load_ends)) {
    return InvalidModel("warm_up.loads size", trial.loads.size(),
                        "the last of rising warm_up.load_ends");
  }
  for (const TaxelLoad& load : trial.loads) {
    if (load.taxel >= static_cast<uint32_t>(taxels)) {
      return InvalidModel("warm_up taxel", load.taxel,
                          absl::StrCat("below ", taxels));
    }
    // Written so that a NaN fails.
    if (!(load.root >= 0 && load.root <= limits::kMaxSignal)) {
      return InvalidModel("warm_up load", load.root,
                          absl::StrCat("0 to ", limits::kMaxSignal));
    }
  }
  return absl::OkStatus();
}

// Inputs made from taxels need a skin that has them.
absl::Status CheckEmbedding(const Model& model) {
  const TaxelEmbedding& embedding = model.inputs.embedding;
  TACTUS_RETURN_IF_ERROR(Validate(embedding));
  const bool used = UsesTaxels(model.inputs);
  const int taxels = used ? model.layout.taxels() : 0;
  if (embedding.taxels != taxels) {
    return InvalidModel("taxels of the embedding", embedding.taxels,
                        absl::StrCat(taxels, used ? ", as the skin has"
                                                  : ": no input needs them"));
  }
  return absl::OkStatus();
}

absl::Status CheckWarmUp(const Model& model) {
  const WarmUpTrial& trial = model.warm_up;
  TACTUS_RETURN_IF_ERROR(
      CheckWarmUpAnswer("probability", trial.probability, model));
  TACTUS_RETURN_IF_ERROR(
      CheckWarmUpAnswer("log_likelihood", trial.log_likelihood, model));
  if (trial.samples.size() > limits::kMaxWarmUpFrames) {
    return InvalidModel("warm_up frames", trial.samples.size(),
                        absl::StrCat("at most ", limits::kMaxWarmUpFrames));
  }
  const auto check = [](absl::string_view name, double value) {
    // Written so that a NaN fails.
    if (std::abs(value) <= limits::kMaxSignal) return absl::OkStatus();
    return InvalidModel(name, value,
                        absl::StrCat("within ", limits::kMaxSignal, " of 0"));
  };
  TACTUS_RETURN_IF_ERROR(CheckLoads(model));
  for (const ContactSample& sample : trial.samples) {
    for (const double value : sample.features) {
      TACTUS_RETURN_IF_ERROR(check("warm_up.signals", value));
    }
    TACTUS_RETURN_IF_ERROR(check("warm_up.net_force", sample.net_force));
    for (const double value : sample.profile) {
      TACTUS_RETURN_IF_ERROR(check("warm_up.profile", value));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status Validate(const Model& model) {
  const bool has_lstm = !model.lstms.empty();
  TACTUS_RETURN_IF_ERROR(CheckClassNames(model.class_names));
  TACTUS_RETURN_IF_ERROR(CheckQuestions(model));
  TACTUS_RETURN_IF_ERROR(Validate(model.inputs, HasHmms(model), has_lstm));
  TACTUS_RETURN_IF_ERROR(CheckHmms(model));
  TACTUS_RETURN_IF_ERROR(CheckLstms(model));
  TACTUS_RETURN_IF_ERROR(
      Validate(model.calibration, model.classes(), has_lstm));
  TACTUS_RETURN_IF_ERROR(CheckLayout(model.layout));
  for (const SkinLayout& layout : model.more_layouts) {
    TACTUS_RETURN_IF_ERROR(CheckLayout(layout));
  }
  TACTUS_RETURN_IF_ERROR(CheckEmbedding(model));
  if (model.skin_range) {
    TACTUS_RETURN_IF_ERROR(Validate(*model.skin_range, model.layout.taxels()));
  }
  TACTUS_RETURN_IF_ERROR(CheckRelease(model.release_after_s));
  TACTUS_RETURN_IF_ERROR(CheckProvenance(model.provenance));
  return CheckWarmUp(model);
}

ContactSample WarmUpTrial::Sample(size_t i) const {
  ContactSample sample = samples[i];
  if (load_ends.empty()) return sample;
  const size_t begin = i == 0 ? 0 : load_ends[i - 1];
  sample.loads = std::span(loads).subspan(begin, load_ends[i] - begin);
  return sample;
}

bool HasHmms(const Model& model) {
  return !model.ridge && !model.nearest && !model.trees;
}

bool NeedsComponents(const Model& model) {
  return (model.ridge && SeesComponents(model.ridge->history)) ||
         (model.nearest && SeesComponents(model.nearest->views)) ||
         (model.trees && SeesComponents(model.trees->history));
}

int TaxelsNeeded(const Model& model) {
  return HasHmms(model) ? model.inputs.embedding.taxels : model.layout.taxels();
}

bool NeedsSkin(const Model& model) {
  return !HasHmms(model) || NeedsSkin(model.inputs);
}

void RemoveEstimator(Model& model) {
  model.estimator.reset();
  model.calibration.softest.clear();
}

std::string SkinMisfit(const Model& model, const SkinLayout& layout) {
  if (model.layout.name.empty()) return "";
  const auto differs = [&](SkinLayout trained) {
    if (!layout.light_touch) trained.light_touch.reset();
    return SkinDifference(layout, trained);
  };
  const bool fits = std::ranges::any_of(
      model.more_layouts,
      [&](const SkinLayout& trained) { return differs(trained).empty(); });
  return fits ? "" : differs(model.layout);
}

}  // namespace tactus::internal
