// File: lstm_from_keras.h
//
// An LSTM classifier from a Keras file in HDF5: LSTM layers, then Dense layers.
// Reads model.save("x.h5") of Keras 2 and 3, which may also have
// BatchNormalization and activations as layers; and files of weights alone,
// model.save_weights("x.h5") of Keras 2 and model.save_weights("x.weights.h5")
// of Keras 3. Other layers are refused by name.
//
//   TACTUS_ASSIGN_OR_RETURN(ForeignModel foreign,
//                           LstmsFromKeras("net.h5", {}));
//   foreign.lstms.front().classes();
//
// Files of weights do not state activations; a file of a whole model does.
// Not thread-safe, like HDF5 itself.
#pragma once

#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "core/interchange/model/foreign_model.h"

namespace tactus::internal {

// What a file of weights does not state: Keras' defaults.
struct KerasOptions {
  Activation activation = Activation::kTanh;
  GateActivation gate_activation = GateActivation::kSigmoid;
  // Activation of all Dense layers but the last. Files with such layers are
  // refused without it.
  std::optional<HiddenActivation> dense_activation = {};
};

// INVALID_MODEL naming the file and the part; IO if it cannot be read. The
// file is read in a child process first (core/files/hdf5_probe.h).
absl::StatusOr<ForeignModel> LstmsFromKeras(const std::string& path,
                                            const KerasOptions& options);

}  // namespace tactus::internal
