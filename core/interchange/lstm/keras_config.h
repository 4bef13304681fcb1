// File: keras_config.h
//
// What the attribute model_config of a Keras file says about the layers that
// have weights.
//
//   TACTUS_ASSIGN_OR_RETURN(KerasConfig config, ParseKerasConfig(text, 2));
//   config.activation;
//
// Thread-safe: a free function without state.
#pragma once

#include <optional>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/lstm/network.h"

namespace tactus {

struct KerasConfig {
  std::optional<Activation> activation;
  std::optional<GateActivation> gate_activation;
};

// `text`: the attribute; `major_version`: of Keras. INVALID_MODEL naming the
// layer if it is of a kind or has an option that is not supported, or if LSTM
// layers have different activations.
absl::StatusOr<KerasConfig> ParseKerasConfig(absl::string_view text,
                                             int major_version);

}  // namespace tactus
