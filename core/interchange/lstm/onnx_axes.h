// File: onnx_axes.h
//
// Operators that move, add and remove axes without changing a number, on data
// of an ONNX graph (onnx_value.h).
//
//   TACTUS_RETURN_IF_ERROR(MoveAxes(node, tensors, &data));
//
// Source: ONNX operator documentation. Thread-safe: a free function without
// state.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "core/interchange/lstm/onnx_node.h"
#include "core/interchange/lstm/onnx_value.h"

namespace tactus::internal {

// The inputs of a node behind its first one, null where they are not stored in
// the file.
using OnnxTensors = std::vector<const onnx::TensorProto*>;

// True for Squeeze, Unsqueeze, Transpose, Reshape, Gather and Slice.
bool MovesAxes(const OnnxNode& node);

// Applies `node`, for which MovesAxes is true, to data behind an LSTM.
// INVALID_MODEL naming the node if it does more than move axes or take the last
// frame.
absl::Status MoveAxes(const OnnxNode& node, const OnnxTensors& tensors,
                      OnnxData* data);

}  // namespace tactus::internal
