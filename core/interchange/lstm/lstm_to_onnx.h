// File: lstm_to_onnx.h
//
// The LSTMs of a model as an ONNX graph that any runtime can run. Several
// networks become one graph that computes their mean probability, as Tactus
// does. docs/interchange.md lists inputs, outputs and metadata.
//
//   TACTUS_ASSIGN_OR_RETURN(std::string bytes,
//                           LstmsToOnnx(model, OnnxGraph::kSequence));
//   TACTUS_RETURN_IF_ERROR(WriteFileBytes("lstm-sequence.onnx", bytes));
//
// The same model gives the same bytes. Thread-safe: free functions without
// state.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/classify/model.h"

namespace tactus::internal {

enum class OnnxGraph {
  // Opset 11: `input` [T, 1, I] -> `probability` [T, 1, classes], from a state
  // of zero; T is free. OpenCV 4.6 loads it if the activations are tanh and
  // sigmoid.
  kSequence,
  // Opset 13: one step, `input` [1, 1, I] -> `probability` [1, 1, classes].
  // Layer l of network n has the state `lstmn_l_h` and `lstmn_l_c` [1, 1, H] as
  // inputs, zero before the first step, and `lstmn_l_h_next` and
  // `lstmn_l_c_next` as outputs: "lstm0_1_h" is that of the second layer.
  kStep,
};

// The model must be valid. INVALID_MODEL if it has no LSTMs.
absl::StatusOr<std::string> LstmsToOnnx(const Model& model, OnnxGraph graph);

}  // namespace tactus::internal
