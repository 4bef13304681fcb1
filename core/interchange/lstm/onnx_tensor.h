// File: onnx_tensor.h
//
// The numbers of a tensor that is stored in an ONNX file.
//
//   TACTUS_ASSIGN_OR_RETURN(OnnxNumbers numbers, NumbersOf(tensor));
//   numbers.shape;  // {1, 200, 2}
//
// Thread-safe: free functions without state.
#pragma once

#include <cstddef>
#include <vector>

#include "absl/status/statusor.h"
#include "core/interchange/lstm/onnx_subset.pb.h"

namespace tactus::internal {

// Row-major.
struct OnnxNumbers {
  std::vector<size_t> shape;
  std::vector<double> values;
};

// Tensors of float, double and int64. INVALID_MODEL naming the tensor if it is
// of another type, lies in another file, or if its size is not what its shape
// calls for.
absl::StatusOr<OnnxNumbers> NumbersOf(const onnx::TensorProto& tensor);

}  // namespace tactus::internal
