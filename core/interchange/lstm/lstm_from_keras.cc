#include "core/interchange/lstm/lstm_from_keras.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/files/hdf5_handle.h"
#include "core/files/hdf5_probe.h"
#include "core/files/hdf5_read.h"
#include "core/interchange/lstm/keras_config.h"
#include "core/interchange/lstm/network_stack.h"
#include "core/interchange/lstm/onnx_names.h"
#include "core/interchange/model/model_file_error.h"

namespace tactus::internal {
namespace {

// An array of weights; columns 0 for a vector.
struct Weights {
  size_t rows = 0;
  size_t columns = 0;
  std::vector<double> values;
};

// The weights of one layer by their names: kernel, recurrent_kernel, bias,
// gamma, beta, moving_mean, moving_variance.
struct KerasLayer {
  std::string name;
  std::map<std::string, Weights> weights;
};

// A group or dataset at `path` under `group`, no step of which is a link to
// another place.
absl::StatusOr<Hdf5Handle> OpenPath(hid_t group, absl::string_view path,
                                    const Hdf5Complaint& complain) {
  Hdf5Handle at;
  for (const absl::string_view step : absl::StrSplit(path, '/')) {
    const std::string name(step);
    const hid_t from = at.ok() ? at.get() : group;
    TACTUS_ASSIGN_OR_RETURN(const bool has,
                            HasHardLink(from, name.c_str(), complain));
    if (!has) return complain(path, "is missing");
    Hdf5Handle next(H5Oopen(from, name.c_str(), H5P_DEFAULT), H5Oclose);
    if (!next.ok()) return complain.Hdf5(path);
    at = std::move(next);
  }
  return at;
}

absl::StatusOr<Weights> ReadWeights(hid_t group, const std::string& path,
                                    const Hdf5Complaint& complain) {
  const size_t slash = path.rfind('/');
  Hdf5Handle folder;
  hid_t parent = group;
  if (slash != std::string::npos) {
    TACTUS_ASSIGN_OR_RETURN(folder,
                            OpenPath(group, path.substr(0, slash), complain));
    parent = folder.get();
  }
  const std::string name = path.substr(slash + 1);
  TACTUS_ASSIGN_OR_RETURN(const bool has,
                          HasHardLink(parent, name.c_str(), complain));
  if (!has) return complain(path, "is missing");
  Hdf5Dataset dataset;
  TACTUS_RETURN_IF_ERROR(OpenDataset(parent, name.c_str(), complain, &dataset));
  if (dataset.dims.size() > 2) {
    return complain(path, "has ", dataset.dims.size(),
                    " axes; 1 or 2 are read");
  }
  Weights out;
  out.rows = dataset.dims[0];
  out.columns = dataset.dims.size() == 2 ? dataset.dims[1] : 0;
  TACTUS_RETURN_IF_ERROR(ReadDoubles(parent, name.c_str(), out.rows,
                                     out.columns, complain, &out.values));
  return out;
}

// What a file of weights alone may have, and what others need.
constexpr char kWeightsAlone[] =
    "; of files of weights alone LSTM and Dense layers are read. Save the "
    "whole "
    "model with model.save(\"net.h5\")";

// "lstm/lstm_cell/kernel:0" -> "kernel".
std::string WeightName(absl::string_view path) {
  absl::string_view name = path.substr(path.rfind('/') + 1);
  return std::string(name.substr(0, name.find(':')));
}

// Keras 2: the attribute layer_names names the groups, weight_names of a group
// its datasets.
absl::StatusOr<std::vector<KerasLayer>> ReadNamedLayers(
    hid_t root, const Hdf5Complaint& complain) {
  std::vector<std::string> names;
  TACTUS_RETURN_IF_ERROR(ReadTextList(root, "layer_names", complain, &names));
  std::vector<KerasLayer> layers;
  for (const std::string& name : names) {
    TACTUS_ASSIGN_OR_RETURN(const Hdf5Handle group,
                            OpenPath(root, name, complain));
    std::vector<std::string> paths;
    TACTUS_RETURN_IF_ERROR(
        ReadTextList(group.get(), "weight_names", complain, &paths));
    if (paths.empty()) continue;
    KerasLayer& layer = layers.emplace_back();
    layer.name = name;
    for (const std::string& path : paths) {
      const std::string meaning = WeightName(path);
      if (layer.weights.contains(meaning)) {
        return complain(absl::StrCat("layer ", name), "has two arrays ",
                        meaning,
                        ", as a Bidirectional layer has; LSTM and Dense layers "
                        "are read");
      }
      TACTUS_ASSIGN_OR_RETURN(layer.weights[meaning],
                              ReadWeights(group.get(), path, complain));
    }
  }
  return layers;
}

// Keras 3: layers/NAME/cell/vars/0, 1 and 2 of an LSTM, layers/NAME/vars/0 and
// 1 of a Dense. The names lstm, lstm_1, ... give the order.
absl::StatusOr<std::vector<KerasLayer>> ReadNumberedLayers(
    hid_t root, const Hdf5Complaint& complain) {
  TACTUS_ASSIGN_OR_RETURN(const Hdf5Handle group,
                          OpenPath(root, "layers", complain));
  TACTUS_ASSIGN_OR_RETURN(std::vector<std::string> names,
                          ListNames(group.get(), complain));
  std::stable_sort(names.begin(), names.end(),
                   [](const std::string& a, const std::string& b) {
                     return a.size() < b.size();
                   });
  std::vector<KerasLayer> layers;
  for (const std::string& name : names) {
    constexpr const char* kNames[] = {"kernel", "recurrent_kernel", "bias"};
    TACTUS_ASSIGN_OR_RETURN(const Hdf5Handle layer_group,
                            OpenPath(group.get(), name, complain));
    TACTUS_ASSIGN_OR_RETURN(const std::vector<std::string> parts,
                            ListNames(layer_group.get(), complain));
    for (const std::string& part : parts) {
      if (part == "vars" || part == "cell" || part == "seed_generator")
        continue;
      return complain(absl::StrCat("layer ", name), "has a part ", part,
                      kWeightsAlone);
    }
    const bool is_lstm = std::ranges::find(parts, "cell") != parts.end();
    TACTUS_ASSIGN_OR_RETURN(
        const Hdf5Handle vars,
        OpenPath(layer_group.get(), is_lstm ? "cell/vars" : "vars", complain));
    TACTUS_ASSIGN_OR_RETURN(const std::vector<std::string> numbers,
                            ListNames(vars.get(), complain));
    // Dropout has the state of its random numbers.
    if (numbers.empty() || absl::StartsWith(name, "dropout")) continue;
    if (numbers.size() > 3) {
      return complain(absl::StrCat("layer ", name), "has ", numbers.size(),
                      " arrays", kWeightsAlone);
    }
    KerasLayer& layer = layers.emplace_back();
    layer.name = name;
    for (size_t i = 0; i < numbers.size(); ++i) {
      const char* meaning = !is_lstm && i == 1 ? "bias" : kNames[i];
      TACTUS_ASSIGN_OR_RETURN(layer.weights[meaning],
                              ReadWeights(vars.get(), numbers[i], complain));
    }
  }
  // LSTMs before the Dense layers.
  std::stable_partition(layers.begin(), layers.end(),
                        [](const KerasLayer& layer) {
                          return layer.weights.contains("recurrent_kernel");
                        });
  return layers;
}

// rows x columns, row-major, as columns x rows in float.
std::vector<float> Transposed(const Weights& weights) {
  std::vector<float> out;
  for (size_t c = 0; c < weights.columns; ++c) {
    for (size_t r = 0; r < weights.rows; ++r) {
      out.push_back(
          static_cast<float>(weights.values[r * weights.columns + c]));
    }
  }
  return out;
}

std::vector<float> BiasOf(const KerasLayer& layer, size_t size) {
  const auto bias = layer.weights.find("bias");
  if (bias == layer.weights.end()) return std::vector<float>(size);
  return {bias->second.values.begin(), bias->second.values.end()};
}

bool HasKernelOf(const KerasLayer& layer, bool lstm) {
  const size_t expected = (lstm ? 2 : 1) + layer.weights.count("bias");
  const auto kernel = layer.weights.find("kernel");
  if (kernel == layer.weights.end() || kernel->second.columns == 0 ||
      layer.weights.size() != expected) {
    return false;
  }
  const size_t columns = kernel->second.columns;
  const auto bias = layer.weights.find("bias");
  if (bias != layer.weights.end() &&
      (bias->second.rows != columns || bias->second.columns != 0)) {
    return false;
  }
  if (!lstm) return true;
  const auto recurrent = layer.weights.find("recurrent_kernel");
  return recurrent != layer.weights.end() &&
         recurrent->second.columns == columns &&
         columns == kLstmGates * recurrent->second.rows;
}

absl::Status CheckWeights(const KerasLayer& layer, bool lstm) {
  if (HasKernelOf(layer, lstm)) return absl::OkStatus();
  std::vector<std::string> names;
  for (const auto& [name, weights] : layer.weights) {
    names.push_back(
        absl::StrCat(name, " (", weights.rows, ", ", weights.columns, ")"));
  }
  return InvalidModel(
      absl::StrCat("layer ", layer.name),
      absl::StrCat("a layer with ", absl::StrJoin(names, ", ")),
      "an LSTM with kernel (inputs, 4 * cells), recurrent_kernel (cells, 4 * "
      "cells) and bias, or a Dense with kernel and bias");
}

absl::Status Fault(const std::string& name, const std::string& fault) {
  if (fault.empty()) return absl::OkStatus();
  return MakeError(absl::StatusCode::kInvalidArgument,
                   v1::ERROR_REASON_INVALID_MODEL,
                   absl::StrCat("layer ", name, " ", fault));
}

// Keras has the gates in our order, i, f, c, o.
absl::Status AddLstm(const KerasLayer& layer, Activation activation,
                     GateActivation gate_activation, NetworkStack* stack) {
  TACTUS_RETURN_IF_ERROR(CheckWeights(layer, /*lstm=*/true));
  const Weights& kernel = layer.weights.at("kernel");
  LstmLayer out;
  out.inputs = static_cast<int>(kernel.rows);
  out.cells = static_cast<int>(kernel.columns / kLstmGates);
  out.kernel = Transposed(kernel);
  out.recurrent = Transposed(layer.weights.at("recurrent_kernel"));
  out.bias = BiasOf(layer, kernel.columns);
  return Fault(layer.name,
               stack->AddLstm(std::move(out), activation, gate_activation));
}

absl::Status AddDense(const KerasLayer& layer, NetworkStack* stack) {
  TACTUS_RETURN_IF_ERROR(CheckWeights(layer, /*lstm=*/false));
  const Weights& kernel = layer.weights.at("kernel");
  return Fault(layer.name, stack->AddDense(static_cast<int>(kernel.columns),
                                           Transposed(kernel),
                                           BiasOf(layer, kernel.columns)));
}

absl::Status AddNormalization(const KerasLayer& layer,
                              const KerasLayerConfig& config,
                              NetworkStack* stack) {
  const auto mean = layer.weights.find("moving_mean");
  const size_t size =
      mean == layer.weights.end() ? 0 : mean->second.values.size();
  // Ones or zeros where the layer has no gamma or beta.
  const auto numbers = [&](const char* name, bool is_there, double absent) {
    const auto found = layer.weights.find(name);
    return found != layer.weights.end() && is_there
               ? found->second.values
               : std::vector<double>(size, absent);
  };
  if (size == 0 || !layer.weights.contains("moving_variance")) {
    return Fault(layer.name, "has no moving_mean or no moving_variance");
  }
  return Fault(
      layer.name,
      stack->Normalize(numbers("gamma", config.has_gamma, 1),
                       numbers("beta", config.has_beta, 0), mean->second.values,
                       numbers("moving_variance", true, 0), config.epsilon));
}

// The layers in the order of the model, each with its weights.
absl::StatusOr<LstmNetwork> NetworkOf(
    const std::vector<KerasLayer>& layers,
    const std::vector<KerasLayerConfig>& configs) {
  using Kind = KerasLayerConfig::Kind;
  NetworkStack stack;
  std::string what = "the model ";
  bool softmax = false;
  size_t used = 0;
  for (const KerasLayerConfig& config : configs) {
    if (softmax) {
      return Fault(config.name, "follows softmax, which comes last");
    }
    if (config.kind != Kind::kActivation) {
      const auto layer = std::ranges::find(
          layers, config.name, [](const auto& l) { return l.name; });
      if (layer == layers.end()) {
        return Fault(config.name, "has no weights in the file");
      }
      ++used;
      if (config.kind == Kind::kLstm) {
        TACTUS_RETURN_IF_ERROR(AddLstm(*layer, config.cell_activation,
                                       config.gate_activation, &stack));
      } else if (config.kind == Kind::kNormalization) {
        TACTUS_RETURN_IF_ERROR(AddNormalization(*layer, config, &stack));
      } else {
        TACTUS_RETURN_IF_ERROR(AddDense(*layer, &stack));
      }
    }
    TACTUS_RETURN_IF_ERROR(
        Fault(config.name, stack.Activate(config.activation)));
    softmax = config.softmax;
    what = absl::StrCat("the model, whose last layer is ", config.name, ", ");
  }
  if (used != layers.size()) {
    return InvalidModel("layers with weights", layers.size(),
                        absl::StrCat(used, ", as model_config lists"));
  }
  std::string fault;
  std::optional<LstmNetwork> network = stack.Finish(softmax, &fault);
  if (!network) {
    return MakeError(absl::StatusCode::kInvalidArgument,
                     v1::ERROR_REASON_INVALID_MODEL, absl::StrCat(what, fault));
  }
  return *std::move(network);
}

// What a file of weights alone lets one know: LSTM layers and Dense layers, of
// which the last gives logits or probabilities.
absl::StatusOr<std::vector<KerasLayerConfig>> ConfigsOf(
    const std::vector<KerasLayer>& layers, const KerasOptions& options) {
  constexpr char kWhole[] =
      "stated: the file has weights alone; save the whole model with "
      "model.save(\"net.h5\")";
  std::vector<KerasLayerConfig> configs;
  for (const KerasLayer& layer : layers) {
    KerasLayerConfig& config = configs.emplace_back();
    config.name = layer.name;
    if (layer.weights.contains("moving_mean")) {
      return InvalidModel(
          absl::StrCat("layer ", layer.name),
          "a BatchNormalization whose place and epsilon are not known", kWhole);
    }
    if (layer.weights.contains("recurrent_kernel")) {
      config.kind = KerasLayerConfig::Kind::kLstm;
      config.cell_activation = options.activation;
      config.gate_activation = options.gate_activation;
    } else if (&layer != &layers.back()) {
      if (!options.dense_activation) {
        return InvalidModel(
            absl::StrCat("activation of the hidden layer ", layer.name),
            "not known", absl::StrCat(kWhole, ", or give --dense-activation"));
      }
      config.activation = *options.dense_activation;
    }
  }
  return configs;
}

absl::StatusOr<ForeignModel> ReadUnprobed(const std::string& path,
                                          const KerasOptions& options) {
  const Hdf5Quiet quiet;
  const Hdf5Complaint complain(path, "");
  const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT),
                        H5Fclose);
  if (!file.ok()) return complain.Hdf5("file");
  std::string config_text;
  std::string version;
  TACTUS_RETURN_IF_ERROR(
      ReadText(file.get(), "model_config", complain, &config_text));
  TACTUS_ASSIGN_OR_RETURN(const bool whole,
                          HasHardLink(file.get(), "model_weights", complain));
  Hdf5Handle weights;
  if (whole) {
    TACTUS_ASSIGN_OR_RETURN(weights,
                            OpenPath(file.get(), "model_weights", complain));
  }
  const hid_t root = whole ? weights.get() : file.get();
  TACTUS_RETURN_IF_ERROR(ReadText(root, "keras_version", complain, &version));
  TACTUS_ASSIGN_OR_RETURN(const bool numbered,
                          HasHardLink(root, "layers", complain));
  TACTUS_ASSIGN_OR_RETURN(const std::vector<KerasLayer> layers,
                          numbered ? ReadNumberedLayers(root, complain)
                                   : ReadNamedLayers(root, complain));
  if (config_text.empty() && layers.empty()) {
    return complain("layer_names",
                    "is missing or empty, so this is no model of Keras; save "
                    "one with model.save(\"net.h5\")");
  }
  auto configs = config_text.empty()
                     ? ConfigsOf(layers, options)
                     : ParseKerasConfig(config_text,
                                        absl::StartsWith(version, "3") ? 3 : 2);
  if (!configs.ok()) return Annotate(configs.status(), path);
  absl::StatusOr<LstmNetwork> network = NetworkOf(layers, *configs);
  if (!network.ok()) return Annotate(network.status(), path);
  if (const absl::Status status = Validate(*network); !status.ok()) {
    return Annotate(status, path);
  }
  ForeignModel out;
  out.lstms.push_back(*std::move(network));
  return out;
}

}  // namespace

absl::StatusOr<ForeignModel> LstmsFromKeras(const std::string& path,
                                            const KerasOptions& options) {
  const absl::Status probed =
      ProbeInChild(path, [&] { return ReadUnprobed(path, options).status(); });
  if (!probed.ok()) return AsModelFileError(probed);
  auto model = ReadUnprobed(path, options);
  if (!model.ok()) return AsModelFileError(model.status());
  return model;
}

}  // namespace tactus::internal
