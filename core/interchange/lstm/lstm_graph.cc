#include "core/interchange/lstm/lstm_graph.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/interchange/lstm/onnx_axes.h"
#include "core/interchange/lstm/onnx_lstm_layer.h"
#include "core/interchange/lstm/onnx_node.h"
#include "core/interchange/lstm/onnx_tensor.h"
#include "core/interchange/lstm/onnx_value.h"

namespace tactus::internal {
namespace {

using Kind = OnnxValue::Kind;

// How far the factor on the sum of n networks may be from 1/n.
constexpr double kFactorTolerance = 1e-5;
// Weights that are copied out of a file in all.
constexpr int64_t kMaxParameters = limits::kMaxBundleBytes / sizeof(float);

absl::StatusOr<bool> IsZero(const onnx::TensorProto& tensor) {
  TACTUS_ASSIGN_OR_RETURN(const OnnxNumbers numbers, NumbersOf(tensor));
  return std::all_of(numbers.values.begin(), numbers.values.end(),
                     [](double value) { return value == 0; });
}

class GraphReader {
 public:
  GraphReader(const onnx::GraphProto& graph, int64_t opset)
      : graph_(graph), opset_(opset) {}

  absl::StatusOr<std::vector<LstmNetwork>> Read() {
    for (const onnx::TensorProto& tensor : graph_.initializer()) {
      OnnxValue& value = values_[tensor.name()] = MakeValue(Kind::kTensor);
      value.tensor = &tensor;
    }
    for (const onnx::ValueInfoProto& input : graph_.input()) {
      if (!values_.contains(input.name())) {
        values_[input.name()] = MakeValue(InputData(input));
      }
    }
    for (int i = 0; i < graph_.node_size(); ++i) {
      TACTUS_RETURN_IF_ERROR(Visit(OnnxNode(graph_.node(i), i)));
    }
    return Finish();
  }

 private:
  static OnnxData InputData(const onnx::ValueInfoProto& input) {
    OnnxData data;
    const onnx::TensorShapeProto& shape = input.type().tensor_type().shape();
    data.one_step = shape.dim_size() > 1;
    for (int i = 0; i + 1 < shape.dim_size(); ++i) {
      data.one_step = data.one_step && shape.dim(i).dim_value() == 1;
    }
    data.stack = std::make_shared<NetworkStack>();
    return data;
  }

  // Null if the node has no such input.
  absl::StatusOr<const OnnxValue*> Input(const OnnxNode& node, int i) const {
    if (node.input(i).empty()) return nullptr;
    const auto found = values_.find(node.input(i));
    if (found == values_.end()) {
      return node.Invalid(absl::StrCat("uses ", Quoted(node.input(i)),
                                       ", which nothing before it makes"));
    }
    return &found->second;
  }

  absl::StatusOr<OnnxNumbers> Tensor(const OnnxNode& node, int i,
                                     const char* name) const {
    TACTUS_ASSIGN_OR_RETURN(const OnnxValue* value, Input(node, i));
    if (value == nullptr || value->kind != Kind::kTensor) {
      return node.Invalid(absl::StrCat(
          "has ", name,
          " that is not stored in the file; export with constants folded"));
    }
    return NumbersOf(*value->tensor);
  }

  absl::Status Visit(const OnnxNode& node) {
    const std::string& type = node.type();
    if (type == "LSTM") return VisitLstm(node);
    std::vector<const OnnxValue*> inputs;
    bool data = false;
    for (int i = 0; i < node.inputs(); ++i) {
      TACTUS_ASSIGN_OR_RETURN(const OnnxValue* value, Input(node, i));
      inputs.push_back(value);
      data = data || (value != nullptr && value->kind == Kind::kData);
    }
    // Dropout changes nothing when a model is used.
    if ((type == "Identity" || type == "Dropout") && !inputs.empty() &&
        inputs[0] != nullptr) {
      return Set(node, *inputs[0]);
    }
    if (type == "Constant") return VisitConstant(node);
    if (type == "Shape") return Set(node, MakeValue(Kind::kShape));
    if (!data || type == "Concat" || type == "Split") {
      return VisitAside(node, inputs);
    }
    if (MovesAxes(node)) return VisitAxes(node, inputs);
    if (type == "MatMul") return VisitMatMul(node);
    if (type == "Gemm") return VisitGemm(node);
    if (type == "Add" || type == "Sub") return VisitSum(node);
    if (type == "Mul" || type == "Div") return VisitFactor(node);
    if (type == "BatchNormalization") return VisitNormalization(node);
    if (type == "Relu") return VisitActivation(node, HiddenActivation::kRelu);
    if (type == "Tanh") return VisitActivation(node, HiddenActivation::kTanh);
    if (type == "Sigmoid") {
      return VisitActivation(node, HiddenActivation::kSigmoid);
    }
    if (type == "Softmax" || type == "LogSoftmax") return VisitSoftmax(node);
    return node.Invalid(
        "is not supported; a graph may have LSTM layers, then linear layers "
        "(Gemm, or MatMul and Add) with Relu, Tanh, Sigmoid, "
        "BatchNormalization and Dropout between them, and Softmax");
  }

  absl::Status VisitConstant(const OnnxNode& node) {
    const onnx::AttributeProto* tensor = node.Find("value");
    OnnxValue value =
        MakeValue(tensor == nullptr ? Kind::kShape : Kind::kTensor);
    if (tensor != nullptr) value.tensor = &tensor->t();
    return Set(node, value);
  }

  // Shapes, zeros and states beside the data.
  absl::Status VisitAside(const OnnxNode& node,
                          const std::vector<const OnnxValue*>& inputs) {
    bool state = false;
    bool zero = !inputs.empty();
    for (const OnnxValue* value : inputs) {
      if (value == nullptr) continue;
      state =
          state || value->kind == Kind::kState || value->kind == Kind::kData;
    }
    if (state) return Set(node, MakeValue(Kind::kState));
    const std::string& type = node.type();
    if (type == "ConstantOfShape") {
      const onnx::AttributeProto* value = node.Find("value");
      if (value != nullptr) {
        TACTUS_ASSIGN_OR_RETURN(zero, IsZero(value->t()));
      }
    } else if (type == "Expand" || type == "Tile" || MovesAxes(node)) {
      zero = zero && inputs[0] != nullptr;
      if (zero && inputs[0]->kind == Kind::kTensor) {
        TACTUS_ASSIGN_OR_RETURN(zero, IsZero(*inputs[0]->tensor));
      } else {
        zero = zero && inputs[0]->kind == Kind::kZero;
      }
    } else {
      zero = false;
    }
    return Set(node, MakeValue(zero ? Kind::kZero : Kind::kShape));
  }

  absl::Status VisitAxes(const OnnxNode& node,
                         const std::vector<const OnnxValue*>& inputs) {
    if (inputs[0] == nullptr || inputs[0]->kind != Kind::kData) {
      return node.Invalid("takes its axes from the data");
    }
    OnnxData data = inputs[0]->data;
    if (data.stage == OnnxStage::kInput) {
      // Axes of one entry may come and go. Anything else is part of a state, or
      // changes the input.
      const bool same = node.type() == "Squeeze" ||
                        node.type() == "Unsqueeze" ||
                        node.type() == "Transpose";
      return Set(node, same ? *inputs[0] : MakeValue(Kind::kState));
    }
    OnnxTensors tensors;
    for (size_t i = 1; i < inputs.size(); ++i) {
      const bool stored =
          inputs[i] != nullptr && inputs[i]->kind == Kind::kTensor;
      tensors.push_back(stored ? inputs[i]->tensor : nullptr);
    }
    TACTUS_RETURN_IF_ERROR(MoveAxes(node, tensors, &data));
    return Set(node, MakeValue(std::move(data)));
  }

  absl::Status CheckState(const OnnxNode& node, int i) const {
    TACTUS_ASSIGN_OR_RETURN(const OnnxValue* value, Input(node, i));
    if (value == nullptr || value->kind == Kind::kZero ||
        value->kind == Kind::kState ||
        (value->kind == Kind::kData &&
         value->data.stage == OnnxStage::kInput)) {
      return absl::OkStatus();
    }
    if (value->kind == Kind::kTensor) {
      TACTUS_ASSIGN_OR_RETURN(const bool zero, IsZero(*value->tensor));
      if (zero) return absl::OkStatus();
    }
    return node.Invalid("starts from a state that is not zero");
  }

  // The data that an LSTM of `layout` takes.
  absl::StatusOr<OnnxData> LstmInput(const OnnxNode& node,
                                     int64_t layout) const {
    TACTUS_ASSIGN_OR_RETURN(const OnnxValue* value, Input(node, 0));
    if (value == nullptr || value->kind != Kind::kData ||
        value->data.stage > OnnxStage::kHidden) {
      return node.Invalid(
          "takes neither the graph's input nor the output of an LSTM");
    }
    const OnnxData& data = value->data;
    if (data.stage == OnnxStage::kInput) return data;
    const std::string& axes = data.axes;
    const size_t time = layout == 0 ? 0 : 1;
    if (axes.size() != 3 || axes[2] != 'F' || axes[1 - time] == 'T' ||
        (axes[time] != 'T' && !data.one_step)) {
      return node.Invalid(
          "takes the output of an LSTM in another order of axes");
    }
    return data;
  }

  absl::Status VisitLstm(const OnnxNode& node) {
    const int64_t layout = node.Int("layout", 0);
    TACTUS_ASSIGN_OR_RETURN(OnnxData data, LstmInput(node, layout));
    TACTUS_ASSIGN_OR_RETURN(const OnnxNumbers w, Tensor(node, 1, "weights W"));
    TACTUS_ASSIGN_OR_RETURN(const OnnxNumbers r, Tensor(node, 2, "weights R"));
    OnnxNumbers b;
    const bool has_bias = !node.input(3).empty();
    if (has_bias) {
      TACTUS_ASSIGN_OR_RETURN(b, Tensor(node, 3, "a bias B"));
    }
    if (!node.input(4).empty()) {
      return node.Invalid("has lengths of sequences, which are not supported");
    }
    if (!node.input(7).empty()) {
      return node.Invalid("has peepholes, which are not supported");
    }
    TACTUS_RETURN_IF_ERROR(CheckState(node, 5));
    TACTUS_RETURN_IF_ERROR(CheckState(node, 6));
    TACTUS_ASSIGN_OR_RETURN(OnnxLstmLayer layer,
                            LayerOf(node, w, r, has_bias ? &b : nullptr));
    TACTUS_RETURN_IF_ERROR(Extend(node, &data, [&](NetworkStack& stack) {
      return stack.AddLstm(std::move(layer.weights), layer.activation,
                           layer.gate_activation);
    }));
    data.stage = OnnxStage::kHidden;
    // Time, directions, batch, cells, or batch first.
    data.axes = layout == 0 ? "T11F" : "1T1F";
    SetOutput(node, 0, MakeValue(data));
    data.axes = "11F";
    SetOutput(node, 1, MakeValue(data));
    SetOutput(node, 2, MakeValue(Kind::kState));
    return absl::OkStatus();
  }

  // Lets `add` add a layer to a copy of the data's layers.
  template <typename Add>
  absl::Status Extend(const OnnxNode& node, OnnxData* data, const Add& add) {
    TACTUS_RETURN_IF_ERROR(Charge(node, *data->stack));
    auto stack = std::make_shared<NetworkStack>(*data->stack);
    if (const std::string fault = add(*stack); !fault.empty()) {
      return node.Invalid(fault);
    }
    TACTUS_RETURN_IF_ERROR(Charge(node, *stack));
    data->stack = std::move(stack);
    return absl::OkStatus();
  }

  // The data that layers behind an LSTM take, from input `i`.
  absl::StatusOr<OnnxData> Features(const OnnxNode& node, int i) const {
    TACTUS_ASSIGN_OR_RETURN(const OnnxValue* value, Input(node, i));
    if (value == nullptr || value->kind != Kind::kData) {
      return node.Invalid("does not take the data");
    }
    const OnnxStage stage = value->data.stage;
    if (stage != OnnxStage::kHidden && stage != OnnxStage::kDense) {
      return node.Invalid(
          stage == OnnxStage::kInput
              ? "comes before the LSTM layers; inputs are scaled by the bundle"
              : "comes behind the softmax");
    }
    return value->data;
  }

  // A linear layer: `kernel` has units x features weights, or features x units
  // if it is `transposed`.
  absl::Status AddDense(const OnnxNode& node, const OnnxNumbers& kernel,
                        bool transposed, OnnxData* data) {
    if (data->axes.empty() || data->axes.back() != 'F') {
      return node.Invalid("must have the features as the last axis");
    }
    const size_t width = data->stack->width();
    const size_t own = transposed ? 0 : 1;
    if (kernel.shape.size() != 2 || kernel.shape[own] != width ||
        kernel.shape[1 - own] - 1 >= limits::kMaxLstmCells) {
      return node.Invalid(absl::StrCat("has no weights of ", width,
                                       " features and 1 to ",
                                       limits::kMaxLstmCells, " units"));
    }
    const size_t units = kernel.shape[1 - own];
    std::vector<float> weights;
    weights.reserve(units * width);
    for (size_t k = 0; k < units; ++k) {
      for (size_t c = 0; c < width; ++c) {
        weights.push_back(static_cast<float>(
            kernel.values[transposed ? c * units + k : k * width + c]));
      }
    }
    data->stage = OnnxStage::kDense;
    return Extend(node, data, [&](NetworkStack& stack) {
      return stack.AddDense(static_cast<int>(units), std::move(weights),
                            std::vector<float>(units));
    });
  }

  // Each feature x becomes scale x + shift.
  absl::Status Scale(const OnnxNode& node, const std::vector<double>& scale,
                     const std::vector<double>& shift, OnnxData* data) {
    return Extend(node, data, [&](NetworkStack& stack) {
      return stack.Scale(scale, shift);
    });
  }

  // One stored number per feature, or one for all, that stand along the
  // features.
  absl::StatusOr<std::vector<double>> PerFeature(const OnnxNode& node, int i,
                                                 const OnnxData& data) const {
    TACTUS_ASSIGN_OR_RETURN(const OnnxNumbers numbers,
                            Tensor(node, i, "a number per feature"));
    const size_t width = data.stack->width();
    if (numbers.values.size() == 1) {
      return std::vector<double>(width, numbers.values[0]);
    }
    if (numbers.values.size() != width || numbers.shape.back() != width ||
        data.axes.empty() || data.axes.back() != 'F') {
      return node.Invalid(absl::StrCat(
          "must have one number, or one per feature along the last axis: ",
          width));
    }
    return numbers.values;
  }

  absl::Status VisitMatMul(const OnnxNode& node) {
    TACTUS_ASSIGN_OR_RETURN(OnnxData data, Features(node, 0));
    TACTUS_ASSIGN_OR_RETURN(const OnnxNumbers kernel,
                            Tensor(node, 1, "weights"));
    TACTUS_RETURN_IF_ERROR(AddDense(node, kernel, /*transposed=*/true, &data));
    return Set(node, MakeValue(std::move(data)));
  }

  absl::Status VisitGemm(const OnnxNode& node) {
    TACTUS_ASSIGN_OR_RETURN(OnnxData data, Features(node, 0));
    if (node.Float("alpha", 1) != 1 || node.Float("beta", 1) != 1 ||
        node.Int("transA", 0) != 0) {
      return node.Invalid(
          "must have alpha and beta of 1 and the data as its first factor");
    }
    TACTUS_ASSIGN_OR_RETURN(const OnnxNumbers kernel,
                            Tensor(node, 1, "weights"));
    TACTUS_RETURN_IF_ERROR(
        AddDense(node, kernel, node.Int("transB", 0) == 0, &data));
    if (!node.input(2).empty()) {
      TACTUS_ASSIGN_OR_RETURN(const std::vector<double> bias,
                              PerFeature(node, 2, data));
      TACTUS_RETURN_IF_ERROR(
          Scale(node, std::vector<double>(bias.size(), 1), bias, &data));
    }
    return Set(node, MakeValue(std::move(data)));
  }

  absl::Status VisitActivation(const OnnxNode& node,
                               HiddenActivation activation) {
    TACTUS_ASSIGN_OR_RETURN(OnnxData data, Features(node, 0));
    TACTUS_RETURN_IF_ERROR(Extend(node, &data, [&](NetworkStack& stack) {
      return stack.Activate(activation);
    }));
    data.stage = OnnxStage::kDense;
    return Set(node, MakeValue(std::move(data)));
  }

  // scale (x - mean) / sqrt(variance + epsilon) + shift, over axis 1.
  absl::Status VisitNormalization(const OnnxNode& node) {
    TACTUS_ASSIGN_OR_RETURN(OnnxData data, Features(node, 0));
    if (node.Int("training_mode", 0) != 0) {
      return node.Invalid("is in training mode; export the model with eval()");
    }
    if (data.axes.size() < 2 || data.axes[1] != 'F') {
      return node.Invalid("must have the features as axis 1");
    }
    const char* names[] = {"a scale", "a shift", "a mean", "a variance"};
    std::vector<double> numbers[4];
    for (int i = 0; i < 4; ++i) {
      TACTUS_ASSIGN_OR_RETURN(OnnxNumbers tensor,
                              Tensor(node, i + 1, names[i]));
      numbers[i] = std::move(tensor.values);
    }
    TACTUS_RETURN_IF_ERROR(Extend(node, &data, [&](NetworkStack& stack) {
      return stack.Normalize(numbers[0], numbers[1], numbers[2], numbers[3],
                             node.Float("epsilon", 1e-5F));
    }));
    return Set(node, MakeValue(std::move(data)));
  }

  // The bias of a linear layer, a summand of features, or the sum of two
  // networks' probabilities.
  absl::Status VisitSum(const OnnxNode& node) {
    TACTUS_ASSIGN_OR_RETURN(const OnnxValue* a, Input(node, 0));
    TACTUS_ASSIGN_OR_RETURN(const OnnxValue* b, Input(node, 1));
    if (a == nullptr || b == nullptr) return node.Invalid("adds nothing");
    const bool minus = node.type() == "Sub";
    if (a->kind == Kind::kData && b->kind == Kind::kData) {
      OnnxData data = a->data;
      if (data.stage != OnnxStage::kProbability || minus ||
          b->data.stage != OnnxStage::kProbability || data.factor != 1 ||
          b->data.factor != 1 || data.axes != b->data.axes) {
        return node.Invalid("may only add probabilities of networks");
      }
      data.sum.insert(data.sum.end(), b->data.sum.begin(), b->data.sum.end());
      if (data.sum.size() > limits::kMaxLstms) {
        return node.Invalid(
            absl::StrCat("adds more than ", limits::kMaxLstms, " networks"));
      }
      return Set(node, MakeValue(std::move(data)));
    }
    const int own = a->kind == Kind::kData ? 0 : 1;
    TACTUS_ASSIGN_OR_RETURN(OnnxData data, Features(node, own));
    TACTUS_ASSIGN_OR_RETURN(std::vector<double> shift,
                            PerFeature(node, 1 - own, data));
    std::vector<double> scale(shift.size(), 1);
    if (minus) {
      std::vector<double>& negated = own == 0 ? shift : scale;
      for (double& value : negated) value = -value;
    }
    TACTUS_RETURN_IF_ERROR(Scale(node, scale, shift, &data));
    return Set(node, MakeValue(std::move(data)));
  }

  // A factor of features, or the mean of several networks.
  absl::Status VisitFactor(const OnnxNode& node) {
    TACTUS_ASSIGN_OR_RETURN(const OnnxValue* a, Input(node, 0));
    const bool first = a != nullptr && a->kind == Kind::kData;
    TACTUS_ASSIGN_OR_RETURN(const OnnxValue* b, Input(node, 1));
    const OnnxValue* value = first ? a : b;
    const bool divides = node.type() == "Div";
    if (value == nullptr || value->kind != Kind::kData || (!first && divides)) {
      return node.Invalid("may only scale the data by stored numbers");
    }
    OnnxData data = value->data;
    if (data.stage != OnnxStage::kProbability) {
      TACTUS_ASSIGN_OR_RETURN(data, Features(node, first ? 0 : 1));
      TACTUS_ASSIGN_OR_RETURN(std::vector<double> scale,
                              PerFeature(node, first ? 1 : 0, data));
      if (divides) {
        for (double& factor : scale) factor = 1 / factor;
      }
      TACTUS_RETURN_IF_ERROR(
          Scale(node, scale, std::vector<double>(scale.size()), &data));
      return Set(node, MakeValue(std::move(data)));
    }
    TACTUS_ASSIGN_OR_RETURN(const OnnxNumbers factor,
                            Tensor(node, first ? 1 : 0, "a factor"));
    if (factor.values.size() != 1) {
      return node.Invalid("must have a single number as factor");
    }
    data.factor *= divides ? 1 / factor.values[0] : factor.values[0];
    return Set(node, MakeValue(std::move(data)));
  }

  absl::Status VisitSoftmax(const OnnxNode& node) {
    TACTUS_ASSIGN_OR_RETURN(const OnnxValue* value, Input(node, 0));
    if (value == nullptr || value->kind != Kind::kData) {
      return node.Invalid("does not take the data");
    }
    OnnxData data = value->data;
    const int64_t rank = static_cast<int64_t>(data.axes.size());
    // Below opset 13 all axes from `axis` on are one.
    int64_t axis = node.Int("axis", opset_ < 13 ? 1 : -1);
    if (axis < 0) axis += rank;
    if (opset_ < 13) {
      while (axis >= 0 && axis < rank && data.axes[axis] == '1') ++axis;
    }
    if ((data.stage != OnnxStage::kHidden && data.stage != OnnxStage::kDense) ||
        axis < 0 || axis >= rank || data.axes[axis] != 'F' ||
        (opset_ < 13 && axis + 1 != rank)) {
      return node.Invalid(
          "must follow the layers of a classifier and run over its classes");
    }
    TACTUS_ASSIGN_OR_RETURN(auto network, Finished(node, data, true));
    data.stage = OnnxStage::kProbability;
    data.sum = {std::move(network)};
    return Set(node, MakeValue(std::move(data)));
  }

  absl::StatusOr<std::shared_ptr<const LstmNetwork>> Finished(
      const OnnxNode& node, const OnnxData& data, bool softmax) {
    TACTUS_RETURN_IF_ERROR(Charge(node, *data.stack));
    std::string fault;
    auto network = data.stack->Finish(softmax, &fault);
    if (!network) {
      return node.Invalid(absl::StrCat("follows a network that ", fault));
    }
    return std::make_shared<const LstmNetwork>(*std::move(network));
  }

  // Counts copied weights, so that a small file cannot take all memory.
  absl::Status Charge(const OnnxNode& node, const NetworkStack& stack) {
    parameters_ += stack.parameter_count();
    if (parameters_ <= kMaxParameters) return absl::OkStatus();
    return node.Invalid(absl::StrCat("makes the networks too large; at most ",
                                     kMaxParameters, " weights are read"));
  }

  absl::Status Set(const OnnxNode& node, OnnxValue value) {
    for (int i = 0; i < node.outputs(); ++i) SetOutput(node, i, value);
    return absl::OkStatus();
  }

  void SetOutput(const OnnxNode& node, int i, OnnxValue value) {
    if (!node.output(i).empty()) values_[node.output(i)] = std::move(value);
  }

  // The output that has come farthest.
  absl::StatusOr<const OnnxData*> Answer() const {
    const OnnxData* best = nullptr;
    bool tie = false;
    for (const onnx::ValueInfoProto& output : graph_.output()) {
      const auto found = values_.find(output.name());
      if (found == values_.end() || found->second.kind != Kind::kData) {
        continue;
      }
      const OnnxData& data = found->second.data;
      if (data.stage < OnnxStage::kDense) continue;
      if (best == nullptr || data.stage > best->stage) {
        best = &data;
        tie = false;
      } else if (data.stage == best->stage) {
        tie = true;
      }
    }
    if (best == nullptr) {
      return InvalidModel("graph output", "not a linear layer behind an LSTM",
                          "the probabilities or logits of a classifier");
    }
    if (tie) {
      return InvalidModel("graph output", "there several times",
                          "one classifier");
    }
    return best;
  }

  absl::StatusOr<std::vector<LstmNetwork>> Finish() const {
    TACTUS_ASSIGN_OR_RETURN(const OnnxData* answer, Answer());
    std::vector<std::shared_ptr<const LstmNetwork>> networks = answer->sum;
    if (networks.empty()) {
      std::string fault;
      auto network = answer->stack->Finish(/*softmax=*/false, &fault);
      if (!network) {
        return MakeError(absl::StatusCode::kInvalidArgument,
                         v1::ERROR_REASON_INVALID_MODEL,
                         absl::StrCat("the graph ", fault));
      }
      networks = {std::make_shared<const LstmNetwork>(*std::move(network))};
    }
    const double count = static_cast<double>(networks.size());
    if (!(std::abs(answer->factor * count - 1) <= kFactorTolerance)) {
      return InvalidModel("factor on the sum of networks", answer->factor,
                          absl::StrCat("1 / ", networks.size()));
    }
    std::vector<LstmNetwork> out;
    for (const auto& network : networks) {
      TACTUS_RETURN_IF_ERROR(Validate(*network));
      out.push_back(*network);
    }
    return out;
  }

  const onnx::GraphProto& graph_;
  const int64_t opset_;
  std::map<std::string, OnnxValue> values_;
  int64_t parameters_ = 0;
};

}  // namespace

absl::StatusOr<std::vector<LstmNetwork>> NetworksOf(
    const onnx::GraphProto& graph, int64_t opset) {
  return GraphReader(graph, opset).Read();
}

}  // namespace tactus::internal
