// File: lstm_from_onnx.h
//
// An LSTM classifier from an ONNX file: LSTM layers, then linear layers with
// Relu, Tanh or Sigmoid between them, and softmax, as Tactus and PyTorch
// (torch.onnx.export) write them. Dropout changes nothing; BatchNormalization
// and stored factors and summands of features become part of the weights.
// Several such networks whose mean is the output are read as well. Every other
// operator is refused by name.
//
//   TACTUS_ASSIGN_OR_RETURN(ForeignModel foreign, LstmsFromOnnx(path, bytes));
//   foreign.lstms.front().classes();
//
// The graph is read for a batch of one. Operators that only move axes or make
// zero states are followed; logits without softmax and its logarithm count as
// probabilities. Source: ONNX operator documentation, opsets 7 to 17.
// Thread-safe: a free function without state.
#pragma once

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/interchange/model/foreign_model.h"

namespace tactus::internal {

// INVALID_MODEL naming `path`, and the node or tensor that is wrong. `path` is
// for error messages only.
absl::StatusOr<ForeignModel> LstmsFromOnnx(absl::string_view path,
                                           absl::string_view bytes);

}  // namespace tactus::internal
