// File: lstm_from_keras.h
//
// An LSTM classifier from Keras weights in HDF5: LSTM layers and one Dense
// layer. Reads model.save_weights("x.h5") and model.save("x.h5") of Keras 2,
// and model.save_weights("x.weights.h5") of Keras 3. Other layers with weights
// are refused by name.
//
//   TACTUS_ASSIGN_OR_RETURN(ForeignModel foreign,
//                           LstmsFromKeras("net.h5", {}));
//   foreign.lstms.front().classes();
//
// Files of weights do not state activations; a file of a whole model does.
// Not thread-safe, like HDF5 itself.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/interchange/model/foreign_model.h"

namespace tactus {

// What a file of weights does not state: Keras' defaults.
struct KerasOptions {
  Activation activation = Activation::kTanh;
  GateActivation gate_activation = GateActivation::kSigmoid;
};

// INVALID_MODEL naming the file and the part; IO if it cannot be read. The
// file is read in a child process first (core/files/hdf5_probe.h).
absl::StatusOr<ForeignModel> LstmsFromKeras(const std::string& path,
                                            const KerasOptions& options);

}  // namespace tactus
