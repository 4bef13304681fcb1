#include "core/interchange/lstm/keras_config.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "nlohmann/json.hpp"

namespace tactus::internal {
namespace {

using nlohmann::json;
using KerasKind = KerasLayerConfig::Kind;

constexpr char kAccepted[] =
    "LSTM, then Dense with relu, tanh, sigmoid, linear or softmax, with "
    "BatchNormalization, Activation, ReLU, Softmax, Dropout or Masking between "
    "them";

// Layers that pass numbers on unchanged when a model is used. Masking hides
// frames that only fill up a sequence, of which a stream has none.
constexpr std::array<absl::string_view, 9> kPassive = {
    "InputLayer",      "Dropout",      "SpatialDropout1D",
    "GaussianNoise",   "Masking",      "ActivityRegularization",
    "GaussianDropout", "AlphaDropout", "Identity"};

// A text of `object`; `absent` if it is not there.
std::string Text(const json& object, const char* key,
                 const std::string& absent) {
  if (!object.is_object()) return absent;
  const auto found = object.find(key);
  if (found == object.end()) return absent;
  return found->is_string() ? found->get<std::string>()
                            : absl::StrCat("no text: ", found->type_name());
}

bool Flag(const json& object, const char* key, bool absent) {
  const auto found = object.find(key);
  return found != object.end() && found->is_boolean() ? found->get<bool>()
                                                      : absent;
}

std::string Part(const std::string& name, const char* what) {
  return absl::StrCat("layer ", name, " ", what);
}

absl::Status ReadLstm(const json& config, int major_version,
                      KerasLayerConfig* out) {
  out->kind = KerasKind::kLstm;
  // The states of return_state may go into another layer.
  for (const char* option : {"go_backwards", "time_major", "return_state"}) {
    if (Flag(config, option, false)) {
      return InvalidModel(Part(out->name, option), "true", "false");
    }
  }
  const std::string activation = Text(config, "activation", "tanh");
  const std::string gate = Text(config, "recurrent_activation", "sigmoid");
  if (activation != "tanh" && activation != "softsign") {
    return InvalidModel(Part(out->name, "activation"), activation,
                        "tanh or softsign in an LSTM");
  }
  // Keras 3 gave the name to clamp(x / 6 + 0.5, 0, 1).
  if (gate != "sigmoid" && !(gate == "hard_sigmoid" && major_version < 3)) {
    return InvalidModel(Part(out->name, "recurrent_activation"), gate,
                        "sigmoid, or hard_sigmoid of Keras 1 and 2");
  }
  out->cell_activation =
      activation == "tanh" ? Activation::kTanh : Activation::kSoftsign;
  out->gate_activation = gate == "sigmoid" ? GateActivation::kSigmoid
                                           : GateActivation::kHardSigmoid;
  return absl::OkStatus();
}

absl::Status ReadActivation(const json& config, KerasLayerConfig* out) {
  const std::string name = Text(config, "activation", "linear");
  out->softmax = name == "softmax";
  if (name == "relu") {
    out->activation = HiddenActivation::kRelu;
  } else if (name == "tanh") {
    out->activation = HiddenActivation::kTanh;
  } else if (name == "sigmoid") {
    out->activation = HiddenActivation::kSigmoid;
  } else if (name != "linear" && !out->softmax) {
    return InvalidModel(Part(out->name, "activation"), name,
                        "relu, tanh, sigmoid, linear or softmax");
  }
  return absl::OkStatus();
}

// The layer ReLU may have a slope, a threshold and a limit.
absl::Status ReadRelu(const json& config, KerasLayerConfig* out) {
  out->kind = KerasKind::kActivation;
  out->activation = HiddenActivation::kRelu;
  for (const char* option : {"max_value", "negative_slope", "threshold"}) {
    const auto found = config.find(option);
    if (found == config.end() || found->is_null() ||
        (found->is_number() && found->get<double>() == 0 &&
         option != std::string("max_value"))) {
      continue;
    }
    return InvalidModel(Part(out->name, option), found->dump(),
                        "not set: max(x, 0) is read");
  }
  return absl::OkStatus();
}

// `sequences`: the layer takes all frames and not the last alone.
absl::Status ReadNormalization(const json& config, bool sequences,
                               KerasLayerConfig* out) {
  out->kind = KerasKind::kNormalization;
  // A list of one axis in Keras 2.
  json axis = config.contains("axis") ? config["axis"] : json(-1);
  if (axis.is_array() && axis.size() == 1) axis = json(axis[0]);
  if (axis != -1 && axis != (sequences ? 2 : 1)) {
    return InvalidModel(Part(out->name, "axis"), axis.dump(),
                        "-1, that of the features");
  }
  const auto epsilon = config.find("epsilon");
  if (epsilon != config.end()) {
    if (!epsilon->is_number()) {
      return InvalidModel(Part(out->name, "epsilon"), epsilon->type_name(),
                          "a number");
    }
    out->epsilon = epsilon->get<double>();
  }
  out->has_gamma = Flag(config, "scale", true);
  out->has_beta = Flag(config, "center", true);
  return absl::OkStatus();
}

// Nothing for a layer that changes nothing.
absl::StatusOr<std::optional<KerasLayerConfig>> ReadLayer(const json& layer,
                                                          int major_version,
                                                          bool sequences) {
  KerasLayerConfig out;
  out.class_name = Text(layer, "class_name", "nothing");
  const std::string& type = out.class_name;
  const json config = layer.is_object() && layer.contains("config") &&
                              layer["config"].is_object()
                          ? layer["config"]
                          : json::object();
  out.name = Text(config, "name", type);
  if (std::ranges::find(kPassive, type) != kPassive.end()) return std::nullopt;
  if (type == "LSTM") {
    TACTUS_RETURN_IF_ERROR(ReadLstm(config, major_version, &out));
    return out;
  }
  if (type == "Dense" || type == "Activation") {
    if (type == "Activation") out.kind = KerasKind::kActivation;
    TACTUS_RETURN_IF_ERROR(ReadActivation(config, &out));
    return out;
  }
  if (type == "TimeDistributed" && config.contains("layer") &&
      config["layer"].is_object()) {
    const json& inner = config["layer"];
    const std::string inner_type = Text(inner, "class_name", "nothing");
    if (std::ranges::find(kPassive, inner_type) != kPassive.end()) {
      return std::nullopt;
    }
    if (inner_type == "Dense" && inner.contains("config")) {
      TACTUS_RETURN_IF_ERROR(ReadActivation(inner["config"], &out));
      return out;
    }
  }
  if (type == "Softmax") {
    out.kind = KerasKind::kActivation;
    out.softmax = true;
    return out;
  }
  if (type == "ReLU") {
    TACTUS_RETURN_IF_ERROR(ReadRelu(config, &out));
    return out;
  }
  if (type == "BatchNormalization") {
    TACTUS_RETURN_IF_ERROR(ReadNormalization(config, sequences, &out));
    return out;
  }
  const std::string inner =
      config.contains("layer") ? Text(config["layer"], "class_name", "") : "";
  return InvalidModel(absl::StrCat("layer ", out.name),
                      inner.empty() ? type : absl::StrCat(type, " of ", inner),
                      kAccepted);
}

// A functional model may have branches. One input, one output and layers that
// take one input each are a chain.
absl::Status CheckChain(const json& config) {
  for (const char* ends : {"input_layers", "output_layers"}) {
    const auto found = config.find(ends);
    // ["name", 0, 0], or a list of these.
    if (found == config.end() || !found->is_array() || found->empty() ||
        !found->front().is_array() || found->size() == 1) {
      continue;
    }
    return InvalidModel(ends, found->size(), "1: layers in one chain are read");
  }
  for (const json& layer : config["layers"]) {
    if (!layer.is_object() || !layer.contains("inbound_nodes")) continue;
    const json& nodes = layer["inbound_nodes"];
    if (!nodes.is_array() || nodes.size() < 2) continue;
    return InvalidModel(Part(Text(layer, "name", "without a name"), "uses"),
                        nodes.size(), "1: layers in one chain are read");
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::vector<KerasLayerConfig>> ParseKerasConfig(
    absl::string_view text, int major_version) {
  const json model = json::parse(text.begin(), text.end(), nullptr,
                                 /*allow_exceptions=*/false);
  const absl::Status wrong =
      InvalidModel("model_config", "of another form", "JSON with layers");
  if (!model.is_object() || !model.contains("config")) return wrong;
  const std::string type = Text(model, "class_name", "");
  if (type != "Sequential" && type != "Functional" && type != "Model") {
    return InvalidModel("model_config class_name", type,
                        "Sequential or Functional");
  }
  // Keras before 2.2.3 has the list of a Sequential here.
  const json& config = model["config"];
  const json* layers = &config;
  if (config.is_object()) {
    if (!config.contains("layers")) return wrong;
    layers = &config["layers"];
    TACTUS_RETURN_IF_ERROR(CheckChain(config));
  }
  if (!layers->is_array()) return wrong;
  std::vector<KerasLayerConfig> out;
  bool sequences = true;
  for (const json& layer : *layers) {
    // Behind the last frame alone there is nothing to flatten.
    if (Text(layer, "class_name", "") == "Flatten" && !sequences) continue;
    TACTUS_ASSIGN_OR_RETURN(const auto read,
                            ReadLayer(layer, major_version, sequences));
    if (!read) continue;
    if (read->kind == KerasKind::kLstm) {
      sequences = layer.contains("config") && layer["config"].is_object() &&
                  Flag(layer["config"], "return_sequences", false);
    }
    out.push_back(*read);
  }
  return out;
}

}  // namespace tactus::internal
