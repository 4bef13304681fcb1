#include "core/bundle/model_proto.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/bundle/learner_proto.h"
#include "core/classify/input_spec.h"
#include "core/skin/layout_proto.h"

namespace tactus::internal {
namespace {

template <typename From, typename To>
void Assign(const From& from, To* to) {
  to->Assign(from.begin(), from.end());
}

template <typename T>
std::vector<T> ToVector(const google::protobuf::RepeatedField<T>& field) {
  return {field.begin(), field.end()};
}

// A pair list read both ways: our enumerator and the wire's.
template <typename Ours, typename Wire, size_t kCount>
struct EnumTable {
  const char* what;
  std::pair<Ours, Wire> rows[kCount];

  Wire ToWire(Ours value) const {
    for (const auto& [ours, wire] : rows) {
      if (ours == value) return wire;
    }
    return Wire{};
  }
  absl::StatusOr<Ours> FromWire(Wire value) const {
    for (const auto& [ours, wire] : rows) {
      if (wire == value) return ours;
    }
    return InvalidModel(what, static_cast<int>(value), "a known value");
  }
};

constexpr EnumTable<CovarianceType, v1::GaussianHmm::CovarianceType, 3>
    kCovarianceTypes{
        "covariance_type",
        {{CovarianceType::kFull, v1::GaussianHmm::COVARIANCE_TYPE_FULL},
         {CovarianceType::kDiagonal, v1::GaussianHmm::COVARIANCE_TYPE_DIAGONAL},
         {CovarianceType::kSpherical,
          v1::GaussianHmm::COVARIANCE_TYPE_SPHERICAL}}};

constexpr EnumTable<Activation, v1::LstmNetwork::Activation, 2> kActivations{
    "activation",
    {{Activation::kTanh, v1::LstmNetwork::ACTIVATION_TANH},
     {Activation::kSoftsign, v1::LstmNetwork::ACTIVATION_SOFTSIGN}}};

constexpr EnumTable<GateActivation, v1::LstmNetwork::GateActivation, 2>
    kGateActivations{
        "gate_activation",
        {{GateActivation::kSigmoid, v1::LstmNetwork::GATE_ACTIVATION_SIGMOID},
         {GateActivation::kHardSigmoid,
          v1::LstmNetwork::GATE_ACTIVATION_HARD_SIGMOID}}};

constexpr EnumTable<HiddenActivation, v1::LstmNetwork::HiddenActivation, 4>
    kHiddenActivations{
        "hidden activation",
        {{HiddenActivation::kLinear, v1::LstmNetwork::HIDDEN_ACTIVATION_LINEAR},
         {HiddenActivation::kRelu, v1::LstmNetwork::HIDDEN_ACTIVATION_RELU},
         {HiddenActivation::kTanh, v1::LstmNetwork::HIDDEN_ACTIVATION_TANH},
         {HiddenActivation::kSigmoid,
          v1::LstmNetwork::HIDDEN_ACTIVATION_SIGMOID}}};

constexpr EnumTable<Question::Kind, v1::Question::Kind, 2> kQuestionKinds{
    "question kind",
    {{Question::kProperty, v1::Question::KIND_PROPERTY},
     {Question::kState, v1::Question::KIND_STATE}}};

constexpr EnumTable<PoseNeed, v1::PoseNeed, 3> kPoseNeeds{
    "poses",
    {{PoseNeed::kEither, v1::POSE_NEED_UNSPECIFIED},
     {PoseNeed::kNeeded, v1::POSE_NEED_NEEDED},
     {PoseNeed::kIgnored, v1::POSE_NEED_IGNORED}}};

constexpr EnumTable<Truth, v1::Truth, 2> kTruths{
    "truth",
    {{Truth::kFinal, v1::TRUTH_FINAL}, {Truth::kSoFar, v1::TRUTH_SO_FAR}}};

constexpr EnumTable<Score, v1::HmmScore, 2> kHmmScores{
    "hmm_score",
    {{Score::kForward, v1::HMM_SCORE_FORWARD},
     {Score::kViterbi, v1::HMM_SCORE_VITERBI}}};

template <typename Names, typename Offsets, typename Scalings>
void ToProto(const std::vector<ModelInput>& inputs, Names* names,
             Offsets* log_offsets, Scalings* scalings) {
  for (const ModelInput& input : inputs) {
    names->Add(std::string(CueName(input.cue)));
    log_offsets->Add(input.log_offset);
    auto* scaling = scalings->Add();
    scaling->set_offset(input.offset);
    scaling->set_gain(input.gain);
  }
}

template <typename Names, typename Offsets, typename Scalings>
absl::StatusOr<std::vector<ModelInput>> FromProto(const Names& names,
                                                  const Offsets& log_offsets,
                                                  const Scalings& scalings) {
  if (log_offsets.size() != names.size() || scalings.size() != names.size()) {
    return InvalidModel("inputs sizes",
                        absl::StrCat(log_offsets.size(), ", ", scalings.size()),
                        absl::StrCat(names.size(), ", one per cue"));
  }
  std::vector<ModelInput> inputs;
  for (int i = 0; i < names.size(); ++i) {
    const std::optional<Cue> cue = ParseCue(names[i]);
    if (!cue) return InvalidModel("inputs cue", names[i], "a known cue");
    inputs.push_back(
        {*cue, log_offsets[i], scalings[i].offset(), scalings[i].gain()});
  }
  return inputs;
}

void ToProto(const InputSpec& spec, v1::InputSpec* out) {
  ToProto(spec.hmm, out->mutable_hmm_cues(), out->mutable_hmm_log_offset(),
          out->mutable_hmm_scaling());
  ToProto(spec.lstm, out->mutable_lstm_cues(), out->mutable_lstm_log_offset(),
          out->mutable_lstm_scaling());
  for (const ModelInput& input : spec.lstm) out->add_lstm_limit(input.limit);
  out->set_hmm_min_interval(spec.hmm_steps.min);
  out->set_hmm_max_interval(spec.hmm_steps.max);
  out->set_lstm_min_interval(spec.lstm_steps.min);
  out->set_lstm_max_interval(spec.lstm_steps.max);
  out->set_hmm_first_step(spec.hmm_steps.first);
  out->set_hmm_interval_divisor(spec.hmm_steps.divisor);
  out->set_lstm_first_step(spec.lstm_steps.first);
  out->set_lstm_interval_divisor(spec.lstm_steps.divisor);
  out->set_sample_rate_hz(spec.sample_rate_hz);
  if (spec.embedding.taxels == 0) return;
  v1::TaxelEmbedding* embedding = out->mutable_embedding();
  embedding->set_taxels(spec.embedding.taxels);
  embedding->set_dimensions(spec.embedding.dimensions);
  Assign(spec.embedding.weights, embedding->mutable_weights());
}

absl::StatusOr<InputSpec> FromProto(const v1::InputSpec& in) {
  InputSpec spec;
  TACTUS_ASSIGN_OR_RETURN(
      spec.hmm,
      FromProto(in.hmm_cues(), in.hmm_log_offset(), in.hmm_scaling()));
  TACTUS_ASSIGN_OR_RETURN(
      spec.lstm,
      FromProto(in.lstm_cues(), in.lstm_log_offset(), in.lstm_scaling()));
  if (in.lstm_limit_size() != static_cast<int>(spec.lstm.size())) {
    return InvalidModel("inputs.lstm_limit size", in.lstm_limit_size(),
                        absl::StrCat(spec.lstm.size(), ", one per LSTM cue"));
  }
  for (size_t i = 0; i < spec.lstm.size(); ++i) {
    spec.lstm[i].limit = in.lstm_limit(static_cast<int>(i));
  }
  const auto divisor = [](uint32_t stated) {
    return stated > 0 ? stated : StepIntervals{}.divisor;
  };
  spec.hmm_steps = {.min = std::max(in.hmm_min_interval(), 1U),
                    .max = std::max(in.hmm_max_interval(), 1U),
                    .first = in.hmm_first_step(),
                    .divisor = divisor(in.hmm_interval_divisor())};
  spec.lstm_steps = {.min = in.lstm_min_interval(),
                     .max = in.lstm_max_interval(),
                     .first = in.lstm_first_step(),
                     .divisor = divisor(in.lstm_interval_divisor())};
  spec.sample_rate_hz = in.sample_rate_hz();
  const v1::TaxelEmbedding& embedding = in.embedding();
  // Validate(Model) compares them with the skin.
  if (embedding.taxels() > limits::kMaxTaxels ||
      embedding.dimensions() > kMaxEmbedding) {
    return InvalidModel(
        "embedding taxels, dimensions",
        absl::StrCat(embedding.taxels(), ", ", embedding.dimensions()),
        absl::StrCat("at most ", limits::kMaxTaxels, ", ", kMaxEmbedding));
  }
  spec.embedding.taxels = static_cast<int>(embedding.taxels());
  spec.embedding.dimensions = static_cast<int>(embedding.dimensions());
  spec.embedding.weights = ToVector(embedding.weights());
  return spec;
}

void ToProto(const GaussianHmm& hmm, v1::GaussianHmm* out) {
  out->set_states(hmm.states);
  out->set_dimensions(hmm.dimensions);
  out->set_covariance_type(kCovarianceTypes.ToWire(hmm.covariance_type));
  Assign(hmm.start, out->mutable_start_probability());
  Assign(hmm.transition, out->mutable_transition());
  Assign(hmm.means, out->mutable_means());
  Assign(hmm.covariances, out->mutable_covariances());
}

absl::StatusOr<GaussianHmm> FromProto(const v1::GaussianHmm& in) {
  GaussianHmm hmm;
  hmm.states = static_cast<int>(in.states());
  hmm.dimensions = static_cast<int>(in.dimensions());
  TACTUS_ASSIGN_OR_RETURN(hmm.covariance_type,
                          kCovarianceTypes.FromWire(in.covariance_type()));
  hmm.start = ToVector(in.start_probability());
  hmm.transition = ToVector(in.transition());
  hmm.means = ToVector(in.means());
  hmm.covariances = ToVector(in.covariances());
  return hmm;
}

void ToProto(const LstmNetwork& network, v1::LstmNetwork* out) {
  out->set_activation(kActivations.ToWire(network.activation));
  out->set_gate_activation(kGateActivations.ToWire(network.gate_activation));
  for (const LstmLayer& layer : network.layers) {
    auto* row = out->add_layers();
    row->set_inputs(layer.inputs);
    row->set_cells(layer.cells);
    Assign(layer.kernel, row->mutable_kernel());
    Assign(layer.recurrent, row->mutable_recurrent());
    Assign(layer.bias, row->mutable_bias());
  }
  for (const HiddenLayer& layer : network.hidden) {
    auto* row = out->add_hidden();
    row->set_inputs(layer.inputs);
    row->set_units(layer.units);
    row->set_activation(kHiddenActivations.ToWire(layer.activation));
    Assign(layer.kernel, row->mutable_kernel());
    Assign(layer.bias, row->mutable_bias());
  }
  Assign(network.dense_kernel, out->mutable_dense_kernel());
  Assign(network.dense_bias, out->mutable_dense_bias());
  out->set_regressions(network.regressions);
}

absl::StatusOr<LstmNetwork> FromProto(const v1::LstmNetwork& in) {
  LstmNetwork network;
  TACTUS_ASSIGN_OR_RETURN(network.activation,
                          kActivations.FromWire(in.activation()));
  TACTUS_ASSIGN_OR_RETURN(network.gate_activation,
                          kGateActivations.FromWire(in.gate_activation()));
  for (const auto& row : in.layers()) {
    LstmLayer& layer = network.layers.emplace_back();
    layer.inputs = static_cast<int>(row.inputs());
    layer.cells = static_cast<int>(row.cells());
    layer.kernel = ToVector(row.kernel());
    layer.recurrent = ToVector(row.recurrent());
    layer.bias = ToVector(row.bias());
  }
  for (const auto& row : in.hidden()) {
    HiddenLayer& layer = network.hidden.emplace_back();
    layer.inputs = static_cast<int>(row.inputs());
    layer.units = static_cast<int>(row.units());
    TACTUS_ASSIGN_OR_RETURN(layer.activation,
                            kHiddenActivations.FromWire(row.activation()));
    layer.kernel = ToVector(row.kernel());
    layer.bias = ToVector(row.bias());
  }
  network.dense_kernel = ToVector(in.dense_kernel());
  network.dense_bias = ToVector(in.dense_bias());
  network.regressions = static_cast<int>(in.regressions());
  return network;
}

void ToProto(const Calibration& c, v1::Calibration* out) {
  Assign(c.frames, out->mutable_frames());
  Assign(c.hmm_inverse_temperature, out->mutable_hmm_inverse_temperature());
  Assign(c.lstm_inverse_temperature, out->mutable_lstm_inverse_temperature());
  Assign(c.lstm_weight, out->mutable_lstm_weight());
  Assign(c.hmm_weight, out->mutable_hmm_weight());
  Assign(c.hmm_bias, out->mutable_hmm_bias());
  Assign(c.lstm_bias, out->mutable_lstm_bias());
  Assign(c.fused_bias, out->mutable_fused_bias());
  Assign(c.evidence_median, out->mutable_evidence_median());
  Assign(c.evidence_deviation, out->mutable_evidence_deviation());
  Assign(c.softest, out->mutable_softest());
  Assign(c.prior, out->mutable_prior());
  out->set_decision_threshold(c.decision_threshold);
  out->set_decision_frames(c.decision_frames);
  out->set_stiffness_deviation_scale(c.stiffness_deviation_scale);
  out->set_moved_deviation_scale(c.moved_deviation_scale);
  out->set_held(c.held);
  Assign(c.question_threshold, out->mutable_question_threshold());
  Assign(c.question_frames, out->mutable_question_frames());
  out->set_hold_after_frames(c.hold_after_frames);
}

// What bundles of earlier releases do not hold.
void FillIn(Calibration& c) {
  const size_t biases = c.frames.size() * c.prior.size();
  if (c.hmm_bias.empty()) c.hmm_bias.assign(biases, 0);
  if (c.lstm_weight.empty()) return;
  if (c.lstm_bias.empty()) c.lstm_bias.assign(biases, 0);
  if (c.fused_bias.empty()) c.fused_bias.assign(biases, 0);
  if (c.hmm_weight.empty()) {
    for (const double weight : c.lstm_weight)
      c.hmm_weight.push_back(1 - weight);
  }
}

Calibration FromProto(const v1::Calibration& in) {
  Calibration c;
  c.frames = ToVector(in.frames());
  c.hmm_inverse_temperature = ToVector(in.hmm_inverse_temperature());
  c.lstm_inverse_temperature = ToVector(in.lstm_inverse_temperature());
  c.lstm_weight = ToVector(in.lstm_weight());
  c.hmm_weight = ToVector(in.hmm_weight());
  c.hmm_bias = ToVector(in.hmm_bias());
  c.lstm_bias = ToVector(in.lstm_bias());
  c.fused_bias = ToVector(in.fused_bias());
  c.evidence_median = ToVector(in.evidence_median());
  c.evidence_deviation = ToVector(in.evidence_deviation());
  c.softest = ToVector(in.softest());
  c.prior = ToVector(in.prior());
  c.decision_threshold = in.decision_threshold();
  c.decision_frames = in.decision_frames();
  c.stiffness_deviation_scale = in.stiffness_deviation_scale();
  c.moved_deviation_scale = in.moved_deviation_scale();
  c.held = in.held();
  c.question_threshold = ToVector(in.question_threshold());
  c.question_frames = ToVector(in.question_frames());
  c.hold_after_frames = in.hold_after_frames();
  FillIn(c);
  return c;
}

void ToProto(const Question& question, v1::Question* out) {
  out->set_name(question.name);
  out->set_kind(kQuestionKinds.ToWire(question.kind));
  for (const std::string& value : question.values) out->add_values(value);
  Assign(question.value_of_class, out->mutable_value_of_class());
}

absl::StatusOr<Question> FromProto(const v1::Question& in) {
  Question question;
  question.name = in.name();
  TACTUS_ASSIGN_OR_RETURN(question.kind, kQuestionKinds.FromWire(in.kind()));
  question.values.assign(in.values().begin(), in.values().end());
  // Validate(Model) refuses indices that are too large, and so negative ones.
  for (const uint32_t value : in.value_of_class()) {
    question.value_of_class.push_back(static_cast<int>(value));
  }
  return question;
}

void ToProto(const Provenance& provenance, v1::Provenance* out) {
  out->set_command(provenance.command);
  out->set_version(provenance.version);
  out->set_trials(provenance.trials);
  out->set_seed(provenance.seed);
  out->set_data(provenance.data);
  out->set_note(provenance.note);
  Assign(provenance.trial_fingerprints, out->mutable_trial_fingerprints());
  out->set_data_sha256(provenance.data_sha256);
  out->set_groups(provenance.groups);
  out->set_conditions(provenance.conditions);
}

Provenance FromProto(const v1::Provenance& in) {
  return {in.command(),
          in.version(),
          in.trials(),
          in.seed(),
          in.data(),
          in.note(),
          {in.trial_fingerprints().begin(), in.trial_fingerprints().end()},
          in.data_sha256(),
          in.groups(),
          in.conditions()};
}

void ToProto(const WarmUpTrial& trial, bool has_profile, v1::WarmUpTrial* out) {
  for (const ContactSample& sample : trial.samples) {
    for (double value : sample.features) out->add_signals(value);
    out->add_net_force(sample.net_force);
    if (has_profile) {
      for (double value : sample.profile) out->add_profile(value);
    }
  }
  Assign(trial.load_ends, out->mutable_load_ends());
  for (const TaxelLoad& load : trial.loads) {
    out->add_load_taxel(load.taxel);
    out->add_load_root(load.root);
  }
  Assign(trial.probability, out->mutable_probability());
  Assign(trial.log_likelihood, out->mutable_log_likelihood());
}

absl::StatusOr<WarmUpTrial> FromProto(const v1::WarmUpTrial& in,
                                      bool has_profile) {
  // A frame takes more memory than it takes bytes in the file.
  if (in.net_force_size() > static_cast<int>(limits::kMaxWarmUpFrames)) {
    return InvalidModel("warm_up frames", in.net_force_size(),
                        absl::StrCat("at most ", limits::kMaxWarmUpFrames));
  }
  if (in.signals_size() != kFeatureCount * in.net_force_size()) {
    return InvalidModel("warm_up.signals size", in.signals_size(),
                        absl::StrCat(kFeatureCount * in.net_force_size(),
                                     ", three a net force"));
  }
  const int profile_size = has_profile ? kProfileSize * in.net_force_size() : 0;
  if (in.profile_size() != profile_size) {
    return InvalidModel("warm_up.profile size", in.profile_size(),
                        absl::StrCat(profile_size));
  }
  WarmUpTrial trial;
  trial.samples.resize(in.net_force_size());
  for (int i = 0; i < in.signals_size(); ++i) {
    ContactSample& sample = trial.samples[i / kFeatureCount];
    sample.features[i % kFeatureCount] = in.signals(i);
    sample.net_force = in.net_force(i / kFeatureCount);
  }
  for (int i = 0; i < in.profile_size(); ++i) {
    trial.samples[i / kProfileSize].profile[i % kProfileSize] = in.profile(i);
  }
  if (in.load_root_size() != in.load_taxel_size()) {
    return InvalidModel("warm_up.load_root size", in.load_root_size(),
                        absl::StrCat(in.load_taxel_size(), ", one per taxel"));
  }
  trial.load_ends = ToVector(in.load_ends());
  trial.loads.resize(in.load_taxel_size());
  for (int i = 0; i < in.load_taxel_size(); ++i) {
    trial.loads[i] = {in.load_taxel(i), in.load_root(i)};
  }
  trial.probability = ToVector(in.probability());
  trial.log_likelihood = ToVector(in.log_likelihood());
  return trial;
}

}  // namespace

v1::ModelBundle ModelToProto(const Model& model) {
  v1::ModelBundle bundle;
  for (const std::string& name : model.class_names) {
    bundle.add_class_names(name);
  }
  for (const Question& question : model.questions) {
    ToProto(question, bundle.add_questions());
  }
  ToProto(model.inputs, bundle.mutable_inputs());
  for (const HmmMixture& mixture : model.hmms) {
    v1::HmmMixture* row = bundle.add_hmms();
    Assign(mixture.log_weight, row->mutable_log_weight());
    for (const GaussianHmm& hmm : mixture.components) {
      ToProto(hmm, row->add_components());
    }
  }
  bundle.set_hmm_score(kHmmScores.ToWire(model.hmm_score));
  LearnersToProto(model, bundle);
  for (const LstmNetwork& network : model.lstms) {
    ToProto(network, bundle.add_lstm());
  }
  if (model.estimator) {
    ToProto(*model.estimator, bundle.mutable_estimator());
  }
  ToProto(model.calibration, bundle.mutable_calibration());
  bundle.set_layout_class(model.layout.name);
  if (!model.layout.name.empty()) {
    *bundle.mutable_geometry() = LayoutToProto(model.layout);
  }
  for (const SkinLayout& layout : model.more_layouts) {
    *bundle.add_more_geometries() = LayoutToProto(layout);
  }
  bundle.set_poses(kPoseNeeds.ToWire(model.poses));
  if (model.truth == Truth::kSoFar) bundle.set_truth(v1::TRUTH_SO_FAR);
  if (model.release_after_s != kDefaultReleaseAfterS) {
    bundle.set_release_after_s(model.release_after_s);
  }
  ToProto(model.provenance, bundle.mutable_provenance());
  ToProto(model.warm_up, UsesProfile(model.inputs), bundle.mutable_warm_up());
  return bundle;
}

absl::StatusOr<Model> ModelFromProto(const v1::ModelBundle& bundle) {
  Model model;
  model.class_names.assign(bundle.class_names().begin(),
                           bundle.class_names().end());
  for (const v1::Question& row : bundle.questions()) {
    TACTUS_ASSIGN_OR_RETURN(Question question, FromProto(row));
    model.questions.push_back(std::move(question));
  }
  TACTUS_ASSIGN_OR_RETURN(model.inputs, FromProto(bundle.inputs()));
  for (const v1::HmmMixture& row : bundle.hmms()) {
    HmmMixture& mixture = model.hmms.emplace_back();
    mixture.log_weight = ToVector(row.log_weight());
    for (const v1::GaussianHmm& component : row.components()) {
      TACTUS_ASSIGN_OR_RETURN(GaussianHmm hmm, FromProto(component));
      mixture.components.push_back(std::move(hmm));
    }
  }
  TACTUS_ASSIGN_OR_RETURN(model.hmm_score,
                          kHmmScores.FromWire(bundle.hmm_score()));
  TACTUS_RETURN_IF_ERROR(LearnersFromProto(bundle, model));
  for (const v1::LstmNetwork& row : bundle.lstm()) {
    TACTUS_ASSIGN_OR_RETURN(LstmNetwork lstm, FromProto(row));
    model.lstms.push_back(std::move(lstm));
  }
  if (bundle.has_estimator()) {
    TACTUS_ASSIGN_OR_RETURN(model.estimator, FromProto(bundle.estimator()));
  }
  model.calibration = FromProto(bundle.calibration());
  if (!bundle.layout_class().empty()) {
    TACTUS_ASSIGN_OR_RETURN(model.layout, LayoutFromProto(bundle.geometry()));
    model.layout.name = bundle.layout_class();
  }
  for (const v1::SensorGeometry& geometry : bundle.more_geometries()) {
    TACTUS_ASSIGN_OR_RETURN(SkinLayout layout, LayoutFromProto(geometry));
    layout.name = bundle.layout_class();
    model.more_layouts.push_back(std::move(layout));
  }
  TACTUS_ASSIGN_OR_RETURN(model.poses, kPoseNeeds.FromWire(bundle.poses()));
  if (bundle.truth() != v1::TRUTH_UNSPECIFIED) {
    TACTUS_ASSIGN_OR_RETURN(model.truth, kTruths.FromWire(bundle.truth()));
  }
  if (bundle.release_after_s() != 0) {
    model.release_after_s = bundle.release_after_s();
  }
  model.provenance = FromProto(bundle.provenance());
  TACTUS_ASSIGN_OR_RETURN(
      model.warm_up, FromProto(bundle.warm_up(), UsesProfile(model.inputs)));
  return model;
}

}  // namespace tactus::internal
