#include "core/interchange/lstm/onnx_node.h"

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/text.h"

namespace tactus::internal {
namespace {

const std::string& NoName() {
  static const std::string kNone;
  return kNone;
}

}  // namespace

const std::string& OnnxNode::input(int i) const {
  return i < node_->input_size() ? node_->input(i) : NoName();
}

const std::string& OnnxNode::output(int i) const {
  return i < node_->output_size() ? node_->output(i) : NoName();
}

const onnx::AttributeProto* OnnxNode::Find(absl::string_view name) const {
  for (const onnx::AttributeProto& attribute : node_->attribute()) {
    if (attribute.name() == name) return &attribute;
  }
  return nullptr;
}

int64_t OnnxNode::Int(absl::string_view name, int64_t absent) const {
  const onnx::AttributeProto* attribute = Find(name);
  return attribute == nullptr ? absent : attribute->i();
}

float OnnxNode::Float(absl::string_view name, float absent) const {
  const onnx::AttributeProto* attribute = Find(name);
  return attribute == nullptr ? absent : attribute->f();
}

std::vector<int64_t> OnnxNode::Ints(absl::string_view name) const {
  const onnx::AttributeProto* attribute = Find(name);
  if (attribute == nullptr) return {};
  return {attribute->ints().begin(), attribute->ints().end()};
}

absl::Status OnnxNode::Invalid(absl::string_view message) const {
  return MakeError(absl::StatusCode::kInvalidArgument,
                   v1::ERROR_REASON_INVALID_MODEL,
                   absl::StrCat("node ", index_, " ", Quoted(node_->name()),
                                " (", node_->op_type(), ") ", message));
}

}  // namespace tactus::internal
