// The examples of public headers, as their comments show them. They only have
// to compile; HouseTest.ExamplesAreCompiled compares the texts.
#include <string>
#include <utility>
#include <vector>

#include "core/base/status_macros.h"
#include "core/classify/warm_up.h"
#include "core/files/draft_file.h"
#include "core/interchange/hmm/hmm_fields.h"
#include "core/interchange/hmm/hmm_json.h"
#include "core/interchange/hmm/hmm_npz.h"
#include "core/interchange/hmm/mixture_weights.h"
#include "core/interchange/lstm/keras_config.h"
#include "core/interchange/lstm/lstm_from_keras.h"
#include "core/interchange/lstm/lstm_from_onnx.h"
#include "core/interchange/lstm/lstm_graph.h"
#include "core/interchange/lstm/lstm_to_onnx.h"
#include "core/interchange/lstm/network_stack.h"
#include "core/interchange/lstm/onnx_axes.h"
#include "core/interchange/lstm/onnx_lstm_layer.h"
#include "core/interchange/lstm/onnx_names.h"
#include "core/interchange/lstm/onnx_node.h"
#include "core/interchange/lstm/onnx_tensor.h"
#include "core/interchange/lstm/onnx_value.h"
#include "core/interchange/model/foreign_model.h"
#include "core/interchange/model/inputs_json.h"
#include "core/interchange/model/model_file_error.h"
#include "core/interchange/read_model_file.h"
#include "core/interchange/replace_models.h"

namespace tactus::examples {

absl::Status ForeignModelExample(Model& model) {
  TACTUS_ASSIGN_OR_RETURN(ForeignModel foreign, ReadModelFile("net.onnx"));
  TACTUS_RETURN_IF_ERROR(ReplaceModels(foreign, model));
  return absl::OkStatus();
}

absl::Status ReplaceModelsExample(Model& model) {
  TACTUS_ASSIGN_OR_RETURN(ForeignModel foreign, ReadModelFile("net.onnx"));
  TACTUS_RETURN_IF_ERROR(ReplaceModels(foreign, model));
  TACTUS_RETURN_IF_ERROR(AnswerWarmUp(model));
  return absl::OkStatus();
}

absl::Status HmmFieldsExample(const GaussianHmm& hmm) {
  const HmmFields fields = FieldsOf(hmm);
  fields.means.shape;  // {states, dimensions}
  TACTUS_ASSIGN_OR_RETURN(GaussianHmm back, HmmOf(fields, "class HU"));
  return absl::OkStatus();
}

absl::Status HmmJsonExample(const Model& model, const std::string& path) {
  const std::string text = HmmsToJson(model, HmmJsonStyle::kHmmlearn);
  TACTUS_ASSIGN_OR_RETURN(ForeignModel foreign, HmmsFromJson(path, text));
  return absl::OkStatus();
}

absl::Status HmmNpzExample(const Model& model, const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(const std::string bytes, HmmsToNpz(model));
  TACTUS_ASSIGN_OR_RETURN(ForeignModel foreign, HmmsFromNpz(path, bytes));
  return absl::OkStatus();
}

void InputsJsonExample(const Model& model) {
  OrderedJson json = OrderedJson::object();
  AddInputs(model.inputs.lstm, model.inputs.lstm_steps, /*rate=*/100, json);
}

absl::Status KerasConfigExample(const std::string& text) {
  TACTUS_ASSIGN_OR_RETURN(std::vector<KerasLayerConfig> layers,
                          ParseKerasConfig(text, /*major_version=*/2));
  layers[0].name;
  return absl::OkStatus();
}

void NetworkStackExample(LstmLayer layer, Activation activation,
                         GateActivation gate_activation,
                         std::vector<float> kernel, std::vector<float> bias) {
  NetworkStack stack;
  std::string fault = stack.AddLstm(layer, activation, gate_activation);
  fault = stack.AddDense(/*units=*/32, kernel, bias);
  fault = stack.Activate(HiddenActivation::kRelu);
  fault = stack.AddDense(/*units=*/4, kernel, bias);
  std::optional<LstmNetwork> network = stack.Finish(/*softmax=*/true, &fault);
}

absl::Status LstmFromKerasExample() {
  TACTUS_ASSIGN_OR_RETURN(ForeignModel foreign, LstmsFromKeras("net.h5", {}));
  foreign.lstms.front().classes();
  return absl::OkStatus();
}

absl::Status LstmFromOnnxExample(const std::string& path,
                                 const std::string& bytes) {
  TACTUS_ASSIGN_OR_RETURN(ForeignModel foreign, LstmsFromOnnx(path, bytes));
  foreign.lstms.front().classes();
  return absl::OkStatus();
}

absl::Status LstmGraphExample(const onnx::ModelProto& model) {
  TACTUS_ASSIGN_OR_RETURN(std::vector<LstmNetwork> networks,
                          NetworksOf(model.graph(), /*opset=*/13));
  return absl::OkStatus();
}

absl::Status LstmToOnnxExample(const Model& model) {
  TACTUS_ASSIGN_OR_RETURN(std::string bytes,
                          LstmsToOnnx(model, OnnxGraph::kSequence));
  TACTUS_RETURN_IF_ERROR(WriteFileBytes("lstm-sequence.onnx", bytes));
  return absl::OkStatus();
}

absl::Status MixtureWeightsExample(HmmMixture mixture) {
  const std::vector<double> weights = WeightsOf(mixture);
  TACTUS_RETURN_IF_ERROR(SetWeights(weights, "class HU", &mixture));
  return absl::OkStatus();
}

absl::Status ModelFileErrorExample(const std::string& path) {
  return InvalidModelFile(path, "node 3 is a Conv; ...");
}

absl::Status OnnxAxesExample(const OnnxNode& node, const OnnxTensors& tensors,
                             OnnxData data) {
  TACTUS_RETURN_IF_ERROR(MoveAxes(node, tensors, &data));
  return absl::OkStatus();
}

absl::Status OnnxLstmLayerExample(const OnnxNode& node, const OnnxNumbers& w,
                                  const OnnxNumbers& r, const OnnxNumbers& b,
                                  LstmNetwork network) {
  TACTUS_ASSIGN_OR_RETURN(OnnxLstmLayer layer, LayerOf(node, w, r, &b));
  network.layers.push_back(layer.weights);
  return absl::OkStatus();
}

void OnnxNamesExample(onnx::TensorProto tensor) {
  tensor.set_data_type(kOnnxFloat);
}

absl::Status OnnxNodeExample(const onnx::NodeProto& proto) {
  const OnnxNode node(proto, 3);
  const int64_t axis = node.Int("axis", -1);
  return node.Invalid("is bidirectional; ...");
}

absl::Status OnnxTensorExample(const onnx::TensorProto& tensor) {
  TACTUS_ASSIGN_OR_RETURN(OnnxNumbers numbers, NumbersOf(tensor));
  numbers.shape;  // {1, 200, 2}
  return absl::OkStatus();
}

void OnnxValueExample(const onnx::GraphProto& graph) {
  OnnxValue value;
  value.kind = OnnxValue::Kind::kTensor;
  value.tensor = &graph.initializer(0);
}

absl::Status ReadModelFileExample(Model& model) {
  TACTUS_ASSIGN_OR_RETURN(ForeignModel foreign, ReadModelFile("net.onnx"));
  TACTUS_RETURN_IF_ERROR(ReplaceModels(foreign, model));
  return absl::OkStatus();
}

}  // namespace tactus::examples
