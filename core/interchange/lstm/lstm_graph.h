// File: lstm_graph.h
//
// Follows an ONNX graph from its input to its output and collects the networks
// that it computes. lstm_from_onnx.h states what is read.
//
//   TACTUS_ASSIGN_OR_RETURN(std::vector<LstmNetwork> networks,
//                           NetworksOf(model.graph(), /*opset=*/13));
//
// Thread-safe: a free function without state.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "core/interchange/lstm/onnx_subset.pb.h"
#include "core/lstm/network.h"

namespace tactus::internal {

// At least one network; all are valid. INVALID_MODEL naming the node.
absl::StatusOr<std::vector<LstmNetwork>> NetworksOf(
    const onnx::GraphProto& graph, int64_t opset);

}  // namespace tactus::internal
