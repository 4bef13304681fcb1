// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
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

namespace tactus::internal::examples {

static absl::Status ForeignModelExample(Model& model) {
#include "core/interchange/model/foreign_model.h.inc"
  return absl::OkStatus();
}

static absl::Status ReplaceModelsExample(Model& model) {
#include "core/interchange/replace_models.h.inc"
  return absl::OkStatus();
}

static absl::Status HmmFieldsExample(const GaussianHmm& hmm) {
#include "core/interchange/hmm/hmm_fields.h.inc"
  return absl::OkStatus();
}

static absl::Status HmmJsonExample(const Model& model,
                                   const std::string& path) {
#include "core/interchange/hmm/hmm_json.h.inc"
  return absl::OkStatus();
}

static absl::Status HmmNpzExample(const Model& model, const std::string& path) {
#include "core/interchange/hmm/hmm_npz.h.inc"
  return absl::OkStatus();
}

static void InputsJsonExample(const Model& model) {
#include "core/interchange/model/inputs_json.h.inc"
}

static absl::Status KerasConfigExample(const std::string& text) {
#include "core/interchange/lstm/keras_config.h.inc"
  return absl::OkStatus();
}

static void NetworkStackExample(LstmLayer layer, Activation activation,
                                GateActivation gate_activation,
                                std::vector<float> kernel,
                                std::vector<float> bias) {
#include "core/interchange/lstm/network_stack.h.inc"
}

static absl::Status LstmFromKerasExample() {
#include "core/interchange/lstm/lstm_from_keras.h.inc"
  return absl::OkStatus();
}

static absl::Status LstmFromOnnxExample(const std::string& path,
                                        const std::string& bytes) {
#include "core/interchange/lstm/lstm_from_onnx.h.inc"
  return absl::OkStatus();
}

static absl::Status LstmGraphExample(const onnx::ModelProto& model) {
#include "core/interchange/lstm/lstm_graph.h.inc"
  return absl::OkStatus();
}

static absl::Status LstmToOnnxExample(const Model& model) {
#include "core/interchange/lstm/lstm_to_onnx.h.inc"
  return absl::OkStatus();
}

static absl::Status MixtureWeightsExample(HmmMixture mixture) {
#include "core/interchange/hmm/mixture_weights.h.inc"
  return absl::OkStatus();
}

static absl::Status ModelFileErrorExample(const std::string& path) {
#include "core/interchange/model/model_file_error.h.inc"
}

static absl::Status OnnxAxesExample(const OnnxNode& node,
                                    const OnnxTensors& tensors, OnnxData data) {
#include "core/interchange/lstm/onnx_axes.h.inc"
  return absl::OkStatus();
}

static absl::Status OnnxLstmLayerExample(const OnnxNode& node,
                                         const OnnxNumbers& w,
                                         const OnnxNumbers& r,
                                         const OnnxNumbers& b,
                                         LstmNetwork network) {
#include "core/interchange/lstm/onnx_lstm_layer.h.inc"
  return absl::OkStatus();
}

static void OnnxNamesExample(onnx::TensorProto tensor) {
#include "core/interchange/lstm/onnx_names.h.inc"
}

static absl::Status OnnxNodeExample(const onnx::NodeProto& proto) {
#include "core/interchange/lstm/onnx_node.h.inc"
}

static absl::Status OnnxTensorExample(const onnx::TensorProto& tensor) {
#include "core/interchange/lstm/onnx_tensor.h.inc"
  return absl::OkStatus();
}

static void OnnxValueExample(const onnx::GraphProto& graph) {
#include "core/interchange/lstm/onnx_value.h.inc"
}

static absl::Status ReadModelFileExample(Model& model) {
#include "core/interchange/read_model_file.h.inc"
  return absl::OkStatus();
}

}  // namespace tactus::internal::examples
