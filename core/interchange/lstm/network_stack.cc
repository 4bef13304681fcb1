#include "core/interchange/lstm/network_stack.h"

#include <cmath>
#include <cstddef>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/limits.h"

namespace tactus::internal {
namespace {

// Hidden layers and the output layer.
constexpr size_t kMostDense = limits::kMaxLstmLayers + 1;

// Puts x -> scale x + shift before rows of weights.
void FoldForward(const std::vector<double>& scale,
                 const std::vector<double>& shift, std::vector<float>* kernel,
                 std::vector<float>* bias) {
  const size_t columns = scale.size();
  for (size_t r = 0; r < bias->size(); ++r) {
    double sum = (*bias)[r];
    for (size_t c = 0; c < columns; ++c) {
      float& weight = (*kernel)[r * columns + c];
      sum += weight * shift[c];
      weight = static_cast<float>(weight * scale[c]);
    }
    (*bias)[r] = static_cast<float>(sum);
  }
}

}  // namespace

std::string NetworkStack::AddLstm(LstmLayer layer, Activation activation,
                                  GateActivation gate_activation) {
  if (has_dense()) {
    return "is an LSTM behind a Dense layer; LSTM layers come first";
  }
  if (network_.layers.size() == limits::kMaxLstmLayers) {
    return absl::StrCat("is one LSTM layer too many; at most ",
                        limits::kMaxLstmLayers, " are read");
  }
  if (has_lstm() && (network_.activation != activation ||
                     network_.gate_activation != gate_activation)) {
    return "has other activations than the LSTM layer before";
  }
  if (pending_) {
    if (pending_->scale.size() != static_cast<size_t>(layer.inputs)) {
      return absl::StrCat("has ", layer.inputs, " inputs behind ",
                          pending_->scale.size(), " normalized features");
    }
    FoldForward(pending_->scale, pending_->shift, &layer.kernel, &layer.bias);
    pending_.reset();
  }
  network_.activation = activation;
  network_.gate_activation = gate_activation;
  network_.layers.push_back(std::move(layer));
  return "";
}

std::string NetworkStack::AddDense(int units, std::vector<float> kernel,
                                   std::vector<float> bias) {
  if (!has_lstm()) return "is a Dense layer before the LSTM layers";
  if (network_.hidden.size() == kMostDense) {
    return absl::StrCat("is one Dense layer too many; at most ", kMostDense,
                        " are read");
  }
  if (units < 1 || units > limits::kMaxLstmCells) {
    return absl::StrCat("has ", units, " units; it may have 1 to ",
                        limits::kMaxLstmCells);
  }
  if (kernel.size() != static_cast<size_t>(units) * width() ||
      bias.size() != static_cast<size_t>(units)) {
    return absl::StrCat("has weights for other features than the ", width(),
                        " of the layer before");
  }
  HiddenLayer layer;
  layer.inputs = width();
  layer.units = units;
  layer.kernel = std::move(kernel);
  layer.bias = std::move(bias);
  if (pending_) {
    FoldForward(pending_->scale, pending_->shift, &layer.kernel, &layer.bias);
    pending_.reset();
  }
  network_.hidden.push_back(std::move(layer));
  open_ = true;
  return "";
}

std::string NetworkStack::Scale(const std::vector<double>& scale,
                                const std::vector<double>& shift) {
  const size_t features = pending_ ? pending_->scale.size() : width();
  if (scale.size() != shift.size() || scale.empty() ||
      (features != 0 && scale.size() != features)) {
    return absl::StrCat("has ", scale.size(), " numbers for ", features,
                        " features");
  }
  if (open()) {
    HiddenLayer& layer = network_.hidden.back();
    for (int r = 0; r < layer.units; ++r) {
      for (int c = 0; c < layer.inputs; ++c) {
        float& weight = layer.kernel[static_cast<size_t>(r) * layer.inputs + c];
        weight = static_cast<float>(weight * scale[r]);
      }
      layer.bias[r] = static_cast<float>(layer.bias[r] * scale[r] + shift[r]);
    }
    return "";
  }
  if (!pending_) {
    pending_ = Affine{scale, shift};
    return "";
  }
  for (size_t i = 0; i < scale.size(); ++i) {
    pending_->shift[i] = pending_->shift[i] * scale[i] + shift[i];
    pending_->scale[i] *= scale[i];
  }
  return "";
}

std::string NetworkStack::Normalize(const std::vector<double>& gamma,
                                    const std::vector<double>& beta,
                                    const std::vector<double>& mean,
                                    const std::vector<double>& variance,
                                    double epsilon) {
  const size_t size = mean.size();
  if (gamma.size() != size || beta.size() != size || variance.size() != size) {
    return absl::StrCat("has ", gamma.size(), " factors, ", beta.size(),
                        " summands, ", size, " means and ", variance.size(),
                        " variances");
  }
  std::vector<double> scale(size);
  std::vector<double> shift(size);
  for (size_t i = 0; i < size; ++i) {
    const double deviation = std::sqrt(variance[i] + epsilon);
    if (!(deviation > 0) || !std::isfinite(deviation)) {
      return absl::StrCat("has the variance ", variance[i], " of feature ", i,
                          "; it must be at least 0, and above 0 with epsilon");
    }
    scale[i] = gamma[i] / deviation;
    shift[i] = beta[i] - mean[i] * scale[i];
  }
  return Scale(scale, shift);
}

std::string NetworkStack::AddIdentity() {
  const auto size = static_cast<size_t>(width());
  std::vector<float> kernel(size * size);
  for (size_t i = 0; i < size; ++i) kernel[i * (size + 1)] = 1;
  return AddDense(static_cast<int>(size), std::move(kernel),
                  std::vector<float>(size));
}

std::string NetworkStack::Activate(HiddenActivation activation) {
  if (activation == HiddenActivation::kLinear) return "";
  if (!has_lstm()) return "is an activation before the LSTM layers";
  if (!open()) {
    if (std::string fault = AddIdentity(); !fault.empty()) return fault;
  }
  network_.hidden.back().activation = activation;
  open_ = false;
  return "";
}

std::optional<LstmNetwork> NetworkStack::Finish(bool softmax,
                                                std::string* fault) const {
  fault->clear();
  if (!has_lstm()) {
    *fault = "has no LSTM layer";
    return std::nullopt;
  }
  NetworkStack stack = *this;
  const bool one_sigmoid =
      !softmax && has_dense() && !open_ && !pending_ &&
      network_.hidden.back().units == 1 &&
      network_.hidden.back().activation == HiddenActivation::kSigmoid;
  if (!stack.open() && softmax) *fault = stack.AddIdentity();
  if (!stack.has_dense()) {
    *fault = "has no Dense layer behind the LSTM layers";
  } else if (!stack.open() && !one_sigmoid) {
    *fault =
        "ends with an activation that gives no probabilities of classes; it "
        "must end with softmax, with a linear layer (logits), or with a single "
        "unit and sigmoid";
  }
  if (!fault->empty()) return std::nullopt;
  LstmNetwork network = std::move(stack.network_);
  HiddenLayer last = std::move(network.hidden.back());
  network.hidden.pop_back();
  if (one_sigmoid) {
    // sigmoid(z) = softmax(0, z) of the second class.
    last.kernel.insert(last.kernel.begin(), last.kernel.size(), 0);
    last.bias.insert(last.bias.begin(), 0);
  }
  network.dense_kernel = std::move(last.kernel);
  network.dense_bias = std::move(last.bias);
  return network;
}

}  // namespace tactus::internal
