// File: read_model_file.h
//
// A model file of another program, by the ending of its name: .onnx, .h5 and
// .hdf5 (Keras), .json and .npz (HMMs). Pickles are refused by name, whatever
// they hold.
//
//   TACTUS_ASSIGN_OR_RETURN(ForeignModel foreign, ReadModelFile("net.onnx"));
//   TACTUS_RETURN_IF_ERROR(ReplaceModels(foreign, model));
//
// Not thread-safe, like HDF5 itself.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/interchange/lstm/lstm_from_keras.h"
#include "core/interchange/model/foreign_model.h"

namespace tactus::internal {

// IO or INVALID_MODEL naming `path`. `keras` is for Keras files alone.
absl::StatusOr<ForeignModel> ReadModelFile(const std::string& path,
                                           const KerasOptions& keras = {});

}  // namespace tactus::internal
