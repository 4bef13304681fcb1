// File: keras_config.h
//
// The layers that the attribute model_config of a Keras file lists, first layer
// first, without those that change nothing when a model is used.
//
//   TACTUS_ASSIGN_OR_RETURN(std::vector<KerasLayerConfig> layers,
//                           ParseKerasConfig(text, /*major_version=*/2));
//   layers[0].name;
//
// Thread-safe: a free function without state.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/lstm/network.h"

namespace tactus::internal {

struct KerasLayerConfig {
  enum class Kind { kLstm, kDense, kNormalization, kActivation };
  Kind kind = Kind::kDense;
  std::string name;
  // The class as Keras names it, TimeDistributed where it holds a Dense layer.
  std::string class_name;
  // kLstm.
  Activation cell_activation = Activation::kTanh;
  GateActivation gate_activation = GateActivation::kSigmoid;
  // kDense and kActivation; `softmax` comes last in a model.
  HiddenActivation activation = HiddenActivation::kLinear;
  bool softmax = false;
  // kNormalization: what is added to the variance, and whether there are gamma
  // and beta.
  double epsilon = 1e-3;
  bool has_gamma = true;
  bool has_beta = true;
};

// `text`: the attribute; `major_version`: of Keras. INVALID_MODEL naming the
// layer if it is of a kind or has an option that is not supported, or if the
// layers are no chain.
absl::StatusOr<std::vector<KerasLayerConfig>> ParseKerasConfig(
    absl::string_view text, int major_version);

}  // namespace tactus::internal
