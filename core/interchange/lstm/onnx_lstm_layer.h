// File: onnx_lstm_layer.h
//
// The weights and activations of an LSTM node of an ONNX graph.
//
//   TACTUS_ASSIGN_OR_RETURN(OnnxLstmLayer layer,
//                           LayerOf(node, w, r, &b));
//   network.layers.push_back(layer.weights);
//
// Source: ONNX operator documentation, LSTM-7 and LSTM-14. Thread-safe: a free
// function without state.
#pragma once

#include "absl/status/statusor.h"
#include "core/interchange/lstm/onnx_node.h"
#include "core/interchange/lstm/onnx_tensor.h"
#include "core/lstm/network.h"

namespace tactus::internal {

struct OnnxLstmLayer {
  LstmLayer weights;
  Activation activation = Activation::kTanh;
  GateActivation gate_activation = GateActivation::kSigmoid;
};

// `w`, `r` and `b` (null: zero) are the node's inputs of those names.
// INVALID_MODEL naming the node if a shape is wrong or an attribute is not
// supported.
absl::StatusOr<OnnxLstmLayer> LayerOf(const OnnxNode& node,
                                      const OnnxNumbers& w,
                                      const OnnxNumbers& r,
                                      const OnnxNumbers* b);

}  // namespace tactus::internal
