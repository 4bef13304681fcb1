#include "core/interchange/lstm/keras_config.h"

#include <algorithm>
#include <array>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "nlohmann/json.hpp"

namespace tactus {
namespace {

using nlohmann::json;

// Layers that pass numbers on unchanged when a model is used.
constexpr std::array<absl::string_view, 5> kPassive = {
    "InputLayer", "Dropout", "SpatialDropout1D", "GaussianNoise",
    "ActivityRegularization"};

// A text of `object`; `absent` if it is not there or of another type.
std::string Text(const json& object, const char* key,
                 const std::string& absent) {
  if (!object.is_object()) return absent;
  const auto found = object.find(key);
  return found == object.end() || !found->is_string()
             ? absent
             : found->get<std::string>();
}

bool Flag(const json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_boolean() && found->get<bool>();
}

template <typename Value>
absl::Status SetOnce(Value value, const std::string& what,
                     std::optional<Value>* out) {
  if (*out && **out != value) {
    return InvalidModel(what, "different between layers",
                        "the same in all LSTM layers");
  }
  *out = value;
  return absl::OkStatus();
}

absl::Status ReadLstm(const json& config, const std::string& name,
                      int major_version, KerasConfig* out) {
  for (const char* option : {"go_backwards", "time_major"}) {
    if (Flag(config, option)) {
      return InvalidModel(absl::StrCat("layer ", name, " ", option), "true",
                          "false");
    }
  }
  const std::string activation = Text(config, "activation", "tanh");
  const std::string gate = Text(config, "recurrent_activation", "sigmoid");
  const std::string what = absl::StrCat("layer ", name, " activation");
  const std::string gate_what =
      absl::StrCat("layer ", name, " recurrent_activation");
  if (activation != "tanh" && activation != "softsign") {
    return InvalidModel(what, activation, "tanh or softsign");
  }
  // Keras 3 gave the name to clamp(x / 6 + 0.5, 0, 1).
  if (gate != "sigmoid" && !(gate == "hard_sigmoid" && major_version < 3)) {
    return InvalidModel(gate_what, gate,
                        "sigmoid, or hard_sigmoid of Keras 1 and 2");
  }
  TACTUS_RETURN_IF_ERROR(
      SetOnce(activation == "tanh" ? Activation::kTanh : Activation::kSoftsign,
              what, &out->activation));
  return SetOnce(gate == "sigmoid" ? GateActivation::kSigmoid
                                   : GateActivation::kHardSigmoid,
                 gate_what, &out->gate_activation);
}

absl::Status ReadDense(const json& config, const std::string& name) {
  const std::string activation = Text(config, "activation", "linear");
  if (activation == "softmax" || activation == "linear") {
    return absl::OkStatus();
  }
  return InvalidModel(absl::StrCat("layer ", name, " activation"), activation,
                      "softmax or linear");
}

absl::Status ReadLayer(const json& layer, int major_version, KerasConfig* out) {
  const std::string type = Text(layer, "class_name", "nothing");
  const json config = layer.is_object() && layer.contains("config") &&
                              layer["config"].is_object()
                          ? layer["config"]
                          : json::object();
  const std::string name = Text(config, "name", type);
  if (std::ranges::find(kPassive, type) != kPassive.end()) {
    return absl::OkStatus();
  }
  if (type == "LSTM") return ReadLstm(config, name, major_version, out);
  if (type == "Dense") return ReadDense(config, name);
  if (type == "TimeDistributed" && config.contains("layer") &&
      Text(config["layer"], "class_name", "") == "Dense" &&
      config["layer"].contains("config")) {
    return ReadDense(config["layer"]["config"], name);
  }
  if ((type == "Activation" && Text(config, "activation", "") == "softmax") ||
      type == "Softmax") {
    return absl::OkStatus();
  }
  return InvalidModel(absl::StrCat("layer ", name), type,
                      "LSTM, Dense, softmax or dropout");
}

}  // namespace

absl::StatusOr<KerasConfig> ParseKerasConfig(absl::string_view text,
                                             int major_version) {
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
  }
  if (!layers->is_array()) return wrong;
  KerasConfig out;
  for (const json& layer : *layers) {
    TACTUS_RETURN_IF_ERROR(ReadLayer(layer, major_version, &out));
  }
  return out;
}

}  // namespace tactus
