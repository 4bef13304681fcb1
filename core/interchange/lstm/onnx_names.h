// File: onnx_names.h
//
// Names and numbers that writing and reading of ONNX have in common.
//
//   tensor.set_data_type(kOnnxFloat);
//
// Constants only.
#pragma once

namespace tactus::internal {

// TensorProto.data_type.
inline constexpr int kOnnxFloat = 1;
inline constexpr int kOnnxInt64 = 7;
inline constexpr int kOnnxDouble = 11;

// AttributeProto.type.
inline constexpr int kOnnxAttributeFloat = 1;
inline constexpr int kOnnxAttributeInt = 2;
inline constexpr int kOnnxAttributeFloats = 6;
inline constexpr int kOnnxAttributeInts = 7;
inline constexpr int kOnnxAttributeStrings = 8;

// Gates of a layer. ONNX has the row blocks i, o, f, c; LstmLayer i, f, c, o.
inline constexpr int kLstmGates = 4;
// The place in LstmLayer of each block of ONNX.
inline constexpr int kGateOfOnnxBlock[kLstmGates] = {0, 3, 1, 2};

// ONNX's HardSigmoid is clamp(alpha x + beta, 0, 1); these are its default and
// what GateActivation::kHardSigmoid is.
inline constexpr float kHardSigmoidAlpha = 0.2F;
inline constexpr float kHardSigmoidBeta = 0.5F;

// Metadata of exported models: a JSON list of texts, and an object as
// core/interchange/model/inputs_json.h has it.
inline constexpr char kOnnxClassNames[] = "tactus.class_names";
inline constexpr char kOnnxInputs[] = "tactus.inputs";

}  // namespace tactus::internal
