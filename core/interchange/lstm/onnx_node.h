// File: onnx_node.h
//
// Reads the attributes of a node of an ONNX graph, and makes errors that name
// the node.
//
//   const OnnxNode node(proto, 3);
//   const int64_t axis = node.Int("axis", -1);
//   return node.Invalid("is bidirectional; ...");
//
// A view: the node's message must outlive it. Immutable and thread-safe.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "core/interchange/lstm/onnx_subset.pb.h"

namespace tactus::internal {

class OnnxNode {
 public:
  // `index`: its place in the graph, for errors.
  OnnxNode(const onnx::NodeProto& node, int index)
      : node_(&node), index_(index) {}

  const std::string& type() const { return node_->op_type(); }
  // Name of input or output `i`; empty if there is none.
  const std::string& input(int i) const;
  const std::string& output(int i) const;
  int inputs() const { return node_->input_size(); }
  int outputs() const { return node_->output_size(); }

  // Null if there is no such attribute.
  const onnx::AttributeProto* Find(absl::string_view name) const;
  // The attribute's value, or `absent`.
  int64_t Int(absl::string_view name, int64_t absent) const;
  float Float(absl::string_view name, float absent) const;
  std::vector<int64_t> Ints(absl::string_view name) const;

  // INVALID_MODEL: `node 3 "name" (LSTM) message`.
  absl::Status Invalid(absl::string_view message) const;

 private:
  const onnx::NodeProto* node_;
  int index_;
};

}  // namespace tactus::internal
