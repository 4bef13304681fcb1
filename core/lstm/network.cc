#include "core/lstm/network.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/random.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

constexpr int kGates = 4;
constexpr int kForgetGate = 1;

absl::Status CheckCount(absl::string_view field, int64_t value, int64_t limit) {
  if (value >= 1 && value <= limit) return absl::OkStatus();
  return InvalidModel(field, value, absl::StrCat("1 to ", limit));
}

absl::Status CheckWeights(absl::string_view field,
                          const std::vector<float>& weights, size_t size) {
  if (weights.size() != size) {
    return InvalidModel(absl::StrCat(field, " size"), weights.size(),
                        absl::StrCat(size));
  }
  for (size_t i = 0; i < size; ++i) {
    if (std::abs(weights[i]) <= limits::kMaxLstmWeight) continue;
    return InvalidModel(
        absl::StrCat(field, "[", i, "]"), weights[i],
        absl::StrCat("finite and between -", limits::kMaxLstmWeight, " and ",
                     limits::kMaxLstmWeight));
  }
  return absl::OkStatus();
}

absl::Status CheckLayer(const LstmLayer& layer, const std::string& name) {
  TACTUS_RETURN_IF_ERROR(
      CheckCount(name + ".inputs", layer.inputs, limits::kMaxLstmCells));
  TACTUS_RETURN_IF_ERROR(
      CheckCount(name + ".cells", layer.cells, limits::kMaxLstmCells));
  const size_t inputs = layer.inputs;
  const size_t cells = layer.cells;
  const size_t rows = kGates * cells;
  TACTUS_RETURN_IF_ERROR(
      CheckWeights(name + ".kernel", layer.kernel, rows * inputs));
  TACTUS_RETURN_IF_ERROR(
      CheckWeights(name + ".recurrent", layer.recurrent, rows * cells));
  return CheckWeights(name + ".bias", layer.bias, rows);
}

// `inputs`: what the layers before it put out.
absl::Status CheckHidden(const HiddenLayer& layer, int inputs,
                         const std::string& name) {
  TACTUS_RETURN_IF_ERROR(
      CheckCount(name + ".units", layer.units, limits::kMaxLstmCells));
  if (layer.inputs != inputs) {
    return InvalidModel(
        name + ".inputs", layer.inputs,
        absl::StrCat(inputs, ", the outputs of the layer before"));
  }
  TACTUS_RETURN_IF_ERROR(CheckWeights(name + ".kernel", layer.kernel,
                                      size_t(layer.units) * inputs));
  return CheckWeights(name + ".bias", layer.bias, layer.units);
}

std::vector<float> GlorotUniform(int count, int fan_in, int fan_out,
                                 Random& random) {
  const double limit = std::sqrt(6.0 / (fan_in + fan_out));
  std::vector<float> weights(count);
  for (float& weight : weights) {
    weight = static_cast<float>(random.Uniform(-limit, limit));
  }
  return weights;
}

}  // namespace

int64_t LstmNetwork::parameter_count() const {
  size_t count = dense_kernel.size() + dense_bias.size();
  for (const LstmLayer& layer : layers) {
    count += layer.kernel.size() + layer.recurrent.size() + layer.bias.size();
  }
  for (const HiddenLayer& layer : hidden) {
    count += layer.kernel.size() + layer.bias.size();
  }
  return static_cast<int64_t>(count);
}

absl::Status Validate(const LstmNetwork& network) {
  TACTUS_RETURN_IF_ERROR(
      CheckCount("lstm.layers", network.layers.size(), limits::kMaxLstmLayers));
  for (size_t i = 0; i < network.layers.size(); ++i) {
    const std::string name = absl::StrCat("lstm.layers[", i, "]");
    TACTUS_RETURN_IF_ERROR(CheckLayer(network.layers[i], name));
    if (i > 0 && network.layers[i].inputs != network.layers[i - 1].cells) {
      return InvalidModel(name + ".inputs", network.layers[i].inputs,
                          absl::StrCat(network.layers[i - 1].cells,
                                       ", the cells of the layer before"));
    }
  }
  if (network.hidden.size() > limits::kMaxLstmLayers) {
    return InvalidModel("lstm.hidden", network.hidden.size(),
                        absl::StrCat("at most ", limits::kMaxLstmLayers));
  }
  int features = network.layers.back().cells;
  for (size_t i = 0; i < network.hidden.size(); ++i) {
    TACTUS_RETURN_IF_ERROR(CheckHidden(network.hidden[i], features,
                                       absl::StrCat("lstm.hidden[", i, "]")));
    features = network.hidden[i].units;
  }
  if (network.regressions < 0 || network.regressions > limits::kMaxClasses) {
    return InvalidModel("lstm.regressions", network.regressions,
                        absl::StrCat("0 to ", limits::kMaxClasses));
  }
  if (network.classes() < 1 || network.classes() > limits::kMaxClasses) {
    return InvalidModel(
        "lstm.dense_bias size", network.dense_bias.size(),
        absl::StrCat("1 to ", limits::kMaxClasses, " plus two per regression"));
  }
  TACTUS_RETURN_IF_ERROR(CheckWeights("lstm.dense_bias", network.dense_bias,
                                      network.dense_bias.size()));
  return CheckWeights("lstm.dense_kernel", network.dense_kernel,
                      network.dense_bias.size() * network.features());
}

LstmNetwork RandomNetwork(int inputs, const std::vector<int>& cells,
                          int classes, Activation activation,
                          GateActivation gate_activation, uint64_t seed,
                          float forget_bias, int regressions) {
  Random random(seed);
  LstmNetwork network;
  network.activation = activation;
  network.gate_activation = gate_activation;
  int width = inputs;
  for (const int count : cells) {
    const int rows = kGates * count;
    LstmLayer& layer = network.layers.emplace_back();
    layer.inputs = width;
    layer.cells = count;
    layer.kernel = GlorotUniform(rows * width, width, count, random);
    layer.recurrent = GlorotUniform(rows * count, count, count, random);
    layer.bias.assign(rows, 0);
    std::fill_n(layer.bias.begin() + kForgetGate * count, count, forget_bias);
    width = count;
  }
  const int outputs = classes + 2 * regressions;
  network.regressions = regressions;
  network.dense_kernel = GlorotUniform(outputs * width, width, outputs, random);
  network.dense_bias.assign(outputs, 0);
  return network;
}

}  // namespace tactus::internal
