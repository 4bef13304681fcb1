// File: onnx_value.h
//
// What is known of a value of an ONNX graph while lstm_graph.h follows it.
//
//   OnnxValue value;
//   value.kind = OnnxValue::Kind::kTensor;
//   value.tensor = &graph.initializer(0);
//
// Plain data, cheap to copy. Tensors belong to the graph's message, which must
// outlive the value.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/interchange/lstm/network_stack.h"
#include "core/interchange/lstm/onnx_subset.pb.h"
#include "core/lstm/network.h"

namespace tactus::internal {

// How far the data has come: the graph's input, behind LSTM layers, behind
// linear layers too, behind the softmax.
enum class OnnxStage { kInput, kHidden, kDense, kProbability };

// The data on its way from the graph's input to its output.
struct OnnxData {
  OnnxStage stage = OnnxStage::kInput;
  // One letter per axis: T time, F features or classes, 1 an axis of one entry
  // (the batch and the directions too). Of no meaning for kInput.
  std::string axes;
  // The input has one frame, so that the last frame is the whole sequence.
  bool one_step = false;
  // The layers so far.
  std::shared_ptr<const NetworkStack> stack;
  // kProbability: the networks whose probabilities were added up, and the
  // factor on the sum.
  std::vector<std::shared_ptr<const LstmNetwork>> sum;
  double factor = 1;
};

struct OnnxValue {
  enum class Kind {
    // Stored in the file.
    kTensor,
    // All zero, whatever its shape.
    kZero,
    // A state of an LSTM, before or after it, in some shape.
    kState,
    // Numbers about shapes.
    kShape,
    kData,
  };
  Kind kind = Kind::kShape;
  // kTensor.
  const onnx::TensorProto* tensor = nullptr;
  // kData.
  OnnxData data;
};

inline OnnxValue MakeValue(OnnxValue::Kind kind) {
  OnnxValue value;
  value.kind = kind;
  return value;
}

inline OnnxValue MakeValue(OnnxData data) {
  OnnxValue value = MakeValue(OnnxValue::Kind::kData);
  value.data = std::move(data);
  return value;
}

}  // namespace tactus::internal
