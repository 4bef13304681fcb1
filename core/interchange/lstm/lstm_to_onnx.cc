#include "core/interchange/lstm/lstm_to_onnx.h"

#include <bit>
#include <span>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/serialize.h"
#include "core/base/version.h"
#include "core/interchange/lstm/onnx_names.h"
#include "core/interchange/lstm/onnx_subset.pb.h"
#include "core/interchange/model/inputs_json.h"

namespace tactus::internal {
namespace {

static_assert(std::endian::native == std::endian::little,
              "raw_data is little-endian");

constexpr int64_t kSequenceOpset = 11;
constexpr int64_t kSequenceIrVersion = 6;
constexpr int64_t kStepOpset = 13;
constexpr int64_t kStepIrVersion = 7;

// Row blocks of `rows` (4H x width) in the order of ONNX.
std::vector<float> InOnnxOrder(const std::vector<float>& rows, size_t cells,
                               size_t width) {
  std::vector<float> ordered;
  const size_t block = cells * width;
  for (const int gate : kGateOfOnnxBlock) {
    const auto begin = rows.begin() + static_cast<ptrdiff_t>(gate * block);
    ordered.insert(ordered.end(), begin, begin + static_cast<ptrdiff_t>(block));
  }
  return ordered;
}

// R x C, row-major, as C x R.
std::vector<float> Transposed(const std::vector<float>& rows, size_t columns) {
  std::vector<float> out;
  const size_t count = rows.size() / columns;
  for (size_t c = 0; c < columns; ++c) {
    for (size_t r = 0; r < count; ++r) out.push_back(rows[r * columns + c]);
  }
  return out;
}

class GraphWriter {
 public:
  GraphWriter(OnnxGraph kind, onnx::GraphProto* graph)
      : kind_(kind), graph_(graph) {}

  void Write(const Model& model) {
    const int64_t inputs = model.lstms.front().inputs();
    const int64_t frames = kind_ == OnnxGraph::kSequence ? 0 : 1;
    AddValue("input", {frames, 1, inputs}, graph_->add_input());
    AddValue("probability", {frames, 1, model.classes()}, graph_->add_output());
    const size_t count = model.lstms.size();
    std::string sum;
    for (size_t n = 0; n < count; ++n) {
      const std::string own =
          count == 1 ? "probability" : absl::StrCat("lstm", n, "_probability");
      WriteNetwork(model.lstms[n], absl::StrCat("lstm", n), own);
      if (n == 0) {
        sum = own;
      } else {
        const std::string next = absl::StrCat("sum_", n);
        AddNode("Add", {sum, own}, {next});
        sum = next;
      }
    }
    if (count > 1) {
      AddTensor("weight", {}, {1 / static_cast<float>(count)});
      AddNode("Mul", {sum, "weight"}, {"probability"});
    }
  }

 private:
  void WriteNetwork(const LstmNetwork& network, const std::string& name,
                    const std::string& output) {
    std::string hidden = "input";
    for (size_t l = 0; l < network.layers.size(); ++l) {
      hidden = WriteLayer(network, network.layers[l],
                          absl::StrCat(name, "_", l), hidden);
    }
    for (size_t i = 0; i < network.hidden.size(); ++i) {
      hidden = WriteHidden(network.hidden[i], absl::StrCat(name, "_hidden_", i),
                           hidden);
    }
    const size_t features = network.features();
    const int64_t classes = network.classes();
    AddTensor(name + "_dense_kernel", {int64_t(features), classes},
              Transposed(network.dense_kernel, features));
    AddTensor(name + "_dense_bias", {classes}, network.dense_bias);
    AddNode("MatMul", {hidden, name + "_dense_kernel"}, {name + "_product"});
    AddNode("Add", {name + "_product", name + "_dense_bias"},
            {name + "_logits"});
    onnx::NodeProto* softmax = AddNode("Softmax", {name + "_logits"}, {output});
    SetInt("axis", 2, softmax);
  }

  // Returns the name of the layer's outputs, [frames, 1, U].
  std::string WriteHidden(const HiddenLayer& layer, const std::string& name,
                          const std::string& input) {
    AddTensor(name + "_kernel", {layer.inputs, layer.units},
              Transposed(layer.kernel, layer.inputs));
    AddTensor(name + "_bias", {layer.units}, layer.bias);
    AddNode("MatMul", {input, name + "_kernel"}, {name + "_product"});
    AddNode("Add", {name + "_product", name + "_bias"}, {name + "_sum"});
    switch (layer.activation) {
      case HiddenActivation::kLinear:
        return name + "_sum";
      case HiddenActivation::kRelu:
        AddNode("Relu", {name + "_sum"}, {name + "_output"});
        break;
      case HiddenActivation::kTanh:
        AddNode("Tanh", {name + "_sum"}, {name + "_output"});
        break;
      case HiddenActivation::kSigmoid:
        AddNode("Sigmoid", {name + "_sum"}, {name + "_output"});
        break;
    }
    return name + "_output";
  }

  // Returns the name of the layer's outputs, [frames, 1, H].
  std::string WriteLayer(const LstmNetwork& network, const LstmLayer& layer,
                         const std::string& name, const std::string& input) {
    const int64_t h = layer.cells;
    const int64_t i = layer.inputs;
    AddTensor(name + "_W", {1, kLstmGates * h, i},
              InOnnxOrder(layer.kernel, layer.cells, layer.inputs));
    AddTensor(name + "_R", {1, kLstmGates * h, h},
              InOnnxOrder(layer.recurrent, layer.cells, layer.cells));
    std::vector<float> bias = InOnnxOrder(layer.bias, layer.cells, 1);
    // The second half belongs to R.
    bias.resize(2 * bias.size());
    AddTensor(name + "_B", {1, 2 * kLstmGates * h}, bias);
    std::vector<std::string> inputs = {input, name + "_W", name + "_R",
                                       name + "_B"};
    std::vector<std::string> outputs = {name + "_Y"};
    if (kind_ == OnnxGraph::kStep) {
      // No lengths of sequences; then the state.
      inputs.insert(inputs.end(), {"", name + "_h", name + "_c"});
      // After one step Y_h is what Y is, without the axis of directions.
      outputs = {"", name + "_h_next", name + "_c_next"};
      for (const char* part : {"_h", "_c"}) {
        AddValue(name + part, {1, 1, h}, graph_->add_input());
        AddValue(absl::StrCat(name, part, "_next"), {1, 1, h},
                 graph_->add_output());
      }
    }
    onnx::NodeProto* lstm = AddNode("LSTM", inputs, outputs);
    SetInt("hidden_size", h, lstm);
    SetActivations(network, lstm);
    if (kind_ == OnnxGraph::kStep) return name + "_h_next";
    onnx::NodeProto* squeeze =
        AddNode("Squeeze", {name + "_Y"}, {name + "_output"});
    onnx::AttributeProto* axes = AddAttribute("axes", squeeze);
    axes->set_type(kOnnxAttributeInts);
    axes->add_ints(1);
    return name + "_output";
  }

  // Nothing for sigmoid and tanh, which are ONNX's default: OpenCV 4.6 knows
  // no others and not every runtime knows the attribute.
  static void SetActivations(const LstmNetwork& network,
                             onnx::NodeProto* lstm) {
    const bool hard = network.gate_activation == GateActivation::kHardSigmoid;
    const bool softsign = network.activation == Activation::kSoftsign;
    if (!hard && !softsign) return;
    onnx::AttributeProto* names = AddAttribute("activations", lstm);
    names->set_type(kOnnxAttributeStrings);
    names->add_strings(hard ? "HardSigmoid" : "Sigmoid");
    names->add_strings(softsign ? "Softsign" : "Tanh");
    names->add_strings(softsign ? "Softsign" : "Tanh");
    if (!hard) return;
    onnx::AttributeProto* alpha = AddAttribute("activation_alpha", lstm);
    alpha->set_type(kOnnxAttributeFloats);
    alpha->add_floats(kHardSigmoidAlpha);
    onnx::AttributeProto* beta = AddAttribute("activation_beta", lstm);
    beta->set_type(kOnnxAttributeFloats);
    beta->add_floats(kHardSigmoidBeta);
  }

  onnx::NodeProto* AddNode(const char* type,
                           const std::vector<std::string>& inputs,
                           const std::vector<std::string>& outputs) {
    onnx::NodeProto* node = graph_->add_node();
    node->set_op_type(type);
    node->set_name(outputs.back());
    for (const std::string& name : inputs) node->add_input(name);
    for (const std::string& name : outputs) node->add_output(name);
    return node;
  }

  static onnx::AttributeProto* AddAttribute(const char* name,
                                            onnx::NodeProto* node) {
    onnx::AttributeProto* attribute = node->add_attribute();
    attribute->set_name(name);
    return attribute;
  }

  static void SetInt(const char* name, int64_t value, onnx::NodeProto* node) {
    onnx::AttributeProto* attribute = AddAttribute(name, node);
    attribute->set_type(kOnnxAttributeInt);
    attribute->set_i(value);
  }

  void AddTensor(const std::string& name, const std::vector<int64_t>& dims,
                 const std::vector<float>& values) {
    onnx::TensorProto* tensor = graph_->add_initializer();
    tensor->set_name(name);
    tensor->set_data_type(kOnnxFloat);
    for (const int64_t size : dims) tensor->add_dims(size);
    tensor->set_raw_data(values.data(), values.size() * sizeof(float));
  }

  // A size of 0 is the free number of frames.
  static void AddValue(const std::string& name,
                       const std::vector<int64_t>& dims,
                       onnx::ValueInfoProto* value) {
    value->set_name(name);
    auto* tensor = value->mutable_type()->mutable_tensor_type();
    tensor->set_elem_type(kOnnxFloat);
    for (const int64_t size : dims) {
      auto* dim = tensor->mutable_shape()->add_dim();
      if (size == 0) {
        dim->set_dim_param("frames");
      } else {
        dim->set_dim_value(size);
      }
    }
  }

  const OnnxGraph kind_;
  onnx::GraphProto* graph_;
};

void AddMetadata(const char* key, const OrderedJson& json,
                 onnx::ModelProto* out) {
  onnx::StringStringEntryProto* entry = out->add_metadata_props();
  entry->set_key(key);
  entry->set_value(json.dump(-1, ' ', /*ensure_ascii=*/false,
                             OrderedJson::error_handler_t::replace));
}

}  // namespace

absl::StatusOr<std::string> LstmsToOnnx(const Model& model, OnnxGraph graph) {
  if (model.lstms.empty()) {
    return InvalidModel("number of LSTMs", 0, "at least 1 to be exported");
  }
  onnx::ModelProto out;
  const bool step = graph == OnnxGraph::kStep;
  out.set_ir_version(step ? kStepIrVersion : kSequenceIrVersion);
  out.set_producer_name("tactus");
  out.set_producer_version(kVersion);
  out.add_opset_import()->set_version(step ? kStepOpset : kSequenceOpset);
  out.mutable_opset_import(0)->set_domain("");
  out.mutable_graph()->set_name(step ? "lstm_step" : "lstm_sequence");
  GraphWriter(graph, out.mutable_graph()).Write(model);
  AddMetadata(kOnnxClassNames, model.class_names, &out);
  OrderedJson inputs = OrderedJson::object();
  AddInputs(model.inputs.lstm, model.inputs.lstm_steps,
            model.inputs.sample_rate_hz, inputs);
  AddMetadata(kOnnxInputs, inputs, &out);
  return SerializeDeterministic(out);
}

}  // namespace tactus::internal
