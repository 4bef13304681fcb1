#include "core/interchange/lstm/onnx_lstm_layer.h"

#include <cmath>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/interchange/lstm/onnx_names.h"

namespace tactus::internal {
namespace {

// Alpha and beta are rounded to float in the file.
constexpr double kRounding = 1e-6;

absl::Status CheckShape(const OnnxNode& node, const char* name,
                        const OnnxNumbers& numbers,
                        const std::vector<size_t>& want) {
  if (numbers.shape == want) return absl::OkStatus();
  return node.Invalid(absl::StrCat(
      "has ", name, " of shape (", absl::StrJoin(numbers.shape, ", "),
      "); it must be (", absl::StrJoin(want, ", "), ")"));
}

// Row blocks of `width` numbers a row, put from ONNX's order into LstmLayer's.
std::vector<float> InOurOrder(const double* rows, size_t cells, size_t width) {
  const size_t block = cells * width;
  std::vector<float> ordered(kLstmGates * block);
  for (size_t b = 0; b < kLstmGates; ++b) {
    for (size_t i = 0; i < block; ++i) {
      ordered[kGateOfOnnxBlock[b] * block + i] =
          static_cast<float>(rows[b * block + i]);
    }
  }
  return ordered;
}

absl::Status CheckAttributes(const OnnxNode& node) {
  const onnx::AttributeProto* direction = node.Find("direction");
  if (direction != nullptr && direction->s() != "forward") {
    return node.Invalid(absl::StrCat(
        "has the direction ", Quoted(direction->s()), "; it must be forward"));
  }
  for (const char* name : {"clip", "output_sequence"}) {
    if (node.Find(name) == nullptr) continue;
    return node.Invalid(
        absl::StrCat("has the attribute ", name, ", which is not supported"));
  }
  if (node.Int("input_forget", 0) != 0) {
    return node.Invalid(
        "couples input and forget gate, which is not supported");
  }
  return absl::OkStatus();
}

// The numbers of `attribute` (alpha or beta) that activation f uses: the first.
bool HasHardSigmoid(const OnnxNode& node, const char* attribute, float want) {
  const onnx::AttributeProto* values = node.Find(attribute);
  return values == nullptr || values->floats_size() == 0 ||
         std::abs(values->floats(0) - want) <= kRounding;
}

absl::Status ReadActivations(const OnnxNode& node, OnnxLstmLayer* layer) {
  const onnx::AttributeProto* names = node.Find("activations");
  if (names == nullptr || names->strings_size() == 0) return absl::OkStatus();
  std::vector<std::string> lower;
  for (const std::string& name : names->strings()) {
    lower.push_back(absl::AsciiStrToLower(name));
  }
  bool known = lower.size() == 3 && lower[1] == lower[2];
  if (known && lower[0] == "hardsigmoid") {
    layer->gate_activation = GateActivation::kHardSigmoid;
    known = HasHardSigmoid(node, "activation_alpha", kHardSigmoidAlpha) &&
            HasHardSigmoid(node, "activation_beta", kHardSigmoidBeta);
  } else {
    known = known && lower[0] == "sigmoid";
  }
  if (known && lower[1] == "softsign") {
    layer->activation = Activation::kSoftsign;
  } else {
    known = known && lower[1] == "tanh";
  }
  if (known) return absl::OkStatus();
  return node.Invalid(absl::StrCat(
      "has the activations ", Quoted(absl::StrJoin(names->strings(), ", ")),
      "; they must be Sigmoid or HardSigmoid (alpha 0.2, beta "
      "0.5), then twice Tanh or twice Softsign"));
}

}  // namespace

absl::StatusOr<OnnxLstmLayer> LayerOf(const OnnxNode& node,
                                      const OnnxNumbers& w,
                                      const OnnxNumbers& r,
                                      const OnnxNumbers* b) {
  TACTUS_RETURN_IF_ERROR(CheckAttributes(node));
  if (w.shape.size() != 3 || r.shape.size() != 3 ||
      r.shape[2] - 1 >= limits::kMaxLstmCells ||
      w.shape[2] - 1 >= limits::kMaxLstmCells) {
    return node.Invalid(absl::StrCat(
        "has weights of shape (", absl::StrJoin(w.shape, ", "), ") and (",
        absl::StrJoin(r.shape, ", "),
        "); they must be (1, 4 * cells, inputs) and (1, 4 * cells, cells), at "
        "most ",
        limits::kMaxLstmCells, " cells and inputs"));
  }
  const size_t cells = r.shape[2];
  const size_t inputs = w.shape[2];
  const size_t rows = kLstmGates * cells;
  TACTUS_RETURN_IF_ERROR(CheckShape(node, "W", w, {1, rows, inputs}));
  TACTUS_RETURN_IF_ERROR(CheckShape(node, "R", r, {1, rows, cells}));
  if (node.Int("hidden_size", static_cast<int64_t>(cells)) !=
      static_cast<int64_t>(cells)) {
    return node.Invalid(absl::StrCat("has hidden_size ",
                                     node.Int("hidden_size", 0),
                                     " but weights of ", cells, " cells"));
  }
  OnnxLstmLayer layer;
  layer.weights.inputs = static_cast<int>(inputs);
  layer.weights.cells = static_cast<int>(cells);
  layer.weights.kernel = InOurOrder(w.values.data(), cells, inputs);
  layer.weights.recurrent = InOurOrder(r.values.data(), cells, cells);
  std::vector<double> bias(rows);
  if (b != nullptr) {
    TACTUS_RETURN_IF_ERROR(CheckShape(node, "B", *b, {1, 2 * rows}));
    for (size_t i = 0; i < rows; ++i) {
      bias[i] = b->values[i] + b->values[rows + i];
    }
  }
  layer.weights.bias = InOurOrder(bias.data(), cells, 1);
  TACTUS_RETURN_IF_ERROR(ReadActivations(node, &layer));
  return layer;
}

}  // namespace tactus::internal
