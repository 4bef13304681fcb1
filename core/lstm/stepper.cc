#include "core/lstm/stepper.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

// Far beyond saturation, and small enough that no sum overflows.
constexpr double kMaxInput = 1e20;

using RowMajor =
    Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Distance of streams in the states of a layer.
int Stride(int inputs, int cells) { return inputs + Padded(cells); }

// Writes rows x columns `weights`, row-major, to `columns` rows of
// Padded(rows).
void Transpose(const std::vector<float>& weights, int rows, int columns,
               float* to) {
  for (int column = 0; column < columns; ++column, to += Padded(rows)) {
    for (int row = 0; row < rows; ++row) {
      to[row] = weights[row * columns + column];
    }
  }
}

void ActivateHidden(HiddenActivation activation,
                    Eigen::Ref<Eigen::VectorXd> values) {
  switch (activation) {
    case HiddenActivation::kLinear:
      return;
    case HiddenActivation::kRelu:
      values = values.cwiseMax(0.0);
      return;
    case HiddenActivation::kTanh:
      for (double& value : values) value = std::tanh(value);
      return;
    case HiddenActivation::kSigmoid:
      for (double& value : values) value = 1 / (1 + std::exp(-value));
      return;
  }
}

}  // namespace

absl::StatusOr<CompiledLstm> CompiledLstm::Create(const LstmNetwork& network) {
  TACTUS_RETURN_IF_ERROR(Validate(network));
  CompiledLstm lstm;
  lstm.activation_ = network.activation;
  lstm.gate_activation_ = network.gate_activation;
  for (const LstmLayer& from : network.layers) {
    const int gates = 4 * from.cells;
    Layer& to = lstm.layers_.emplace_back();
    to.inputs = from.inputs;
    to.cells = from.cells;
    to.weights.resize(size_t(from.inputs + from.cells) * Padded(gates));
    Transpose(from.kernel, gates, from.inputs, to.weights.data());
    Transpose(from.recurrent, gates, from.cells,
              &to.weights[size_t(from.inputs) * Padded(gates)]);
    to.bias.resize(Padded(gates));
    std::copy(from.bias.begin(), from.bias.end(), to.bias.begin());
  }
  for (const HiddenLayer& from : network.hidden) {
    lstm.hidden_.push_back(
        {from.activation,
         Eigen::Map<const RowMajor>(from.kernel.data(), from.units, from.inputs)
             .cast<double>(),
         Eigen::Map<const Eigen::VectorXf>(from.bias.data(), from.units)
             .cast<double>()});
  }
  const auto outputs = static_cast<int>(network.dense_bias.size());
  const int features = network.features();
  lstm.regressions_ = network.regressions;
  lstm.dense_kernel_ =
      Eigen::Map<const RowMajor>(network.dense_kernel.data(), outputs, features)
          .cast<double>();
  lstm.dense_bias_ =
      Eigen::Map<const Eigen::VectorXf>(network.dense_bias.data(), outputs)
          .cast<double>();
  return lstm;
}

LstmStepper::LstmStepper(const CompiledLstm& lstm, int streams,
                         const LstmKernels& kernels)
    : lstm_(&lstm), kernels_(&kernels), streams_(streams) {
  for (const CompiledLstm::Layer& layer : lstm.layers_) {
    State& state = states_.emplace_back();
    const size_t size = size_t(streams) * Stride(layer.inputs, layer.cells);
    state.input_output.resize(size);
    state.cell.resize(size);
    state.squashed.resize(size);
    // The kernels read on past the last row.
    state.gates.resize(size_t(streams) * layer.bias.size() + kLstmLanes);
  }
  output_.resize(lstm.layers_.back().cells, streams);
  for (const CompiledLstm::Hidden& layer : lstm.hidden_) {
    hidden_.emplace_back(layer.bias.size(), streams);
  }
  dense_.resize(lstm.dense_bias_.size(), streams);
  probability_.resize(lstm.classes(), streams);
  Reset();
}

void LstmStepper::Reset() {
  for (int stream = 0; stream < streams_; ++stream) Reset(stream);
}

void LstmStepper::Reset(int stream) {
  for (size_t i = 0; i < states_.size(); ++i) {
    const CompiledLstm::Layer& layer = lstm_->layers_[i];
    const int stride = Stride(layer.inputs, layer.cells);
    const ptrdiff_t at = ptrdiff_t{stream} * stride;
    std::fill_n(&states_[i].input_output[at], stride, 0.0F);
    std::fill_n(&states_[i].cell[at], stride, 0.0F);
  }
  dense_.col(stream).setZero();
  probability_.col(stream).setConstant(1.0 / lstm_->classes());
}

void LstmStepper::Step(std::span<const double> input) {
  const CompiledLstm::Layer& first = lstm_->layers_.front();
  float* to = states_.front().input_output.data();
  for (int stream = 0; stream < streams_; ++stream) {
    for (int i = 0; i < first.inputs; ++i) {
      to[i] = static_cast<float>(std::clamp(
          input[size_t(stream) * first.inputs + i], -kMaxInput, kMaxInput));
    }
    to += Stride(first.inputs, first.cells);
  }
  for (size_t i = 0; i < states_.size(); ++i) StepLayer(i);
  StepHidden();
  Softmax();
}

void LstmStepper::StepLayer(size_t index) {
  const CompiledLstm::Layer& layer = lstm_->layers_[index];
  State& state = states_[index];
  const int stride = Stride(layer.inputs, layer.cells);
  const int gates = Padded(4 * layer.cells);
  kernels_->product({.rows = streams_,
                     .inner = layer.inputs + layer.cells,
                     .columns = gates,
                     .a = state.input_output.data(),
                     .a_row = stride,
                     .b = layer.weights.data(),
                     .b_row = gates,
                     .start = layer.bias.data(),
                     .c = state.gates.data(),
                     .c_row = gates});
  float* output = state.input_output.data() + layer.inputs;
  kernels_->cell_forward({.shape = {.rows = streams_,
                                    .cells = layer.cells,
                                    .activation = lstm_->activation_,
                                    .gate_activation = lstm_->gate_activation_,
                                    .gate_row = gates,
                                    .cell_row = stride},
                          .gates = state.gates.data(),
                          .previous = state.cell.data(),
                          .cell = state.cell.data(),
                          .squashed = state.squashed.data(),
                          .output = output});
  const bool last = index + 1 == states_.size();
  for (int stream = 0; stream < streams_; ++stream, output += stride) {
    if (last) {
      std::copy_n(output, layer.cells, output_.col(stream).data());
    } else {
      const CompiledLstm::Layer& next = lstm_->layers_[index + 1];
      std::copy_n(
          output, layer.cells,
          &states_[index + 1].input_output[ptrdiff_t{stream} *
                                           Stride(next.inputs, next.cells)]);
    }
  }
}

void LstmStepper::StepHidden() {
  const Eigen::MatrixXd* input = &output_;
  for (size_t i = 0; i < hidden_.size(); ++i) {
    const CompiledLstm::Hidden& layer = lstm_->hidden_[i];
    for (int stream = 0; stream < streams_; ++stream) {
      auto output = hidden_[i].col(stream);
      output = layer.bias;
      output.noalias() += layer.kernel * input->col(stream);
      ActivateHidden(layer.activation, output);
    }
    input = &hidden_[i];
  }
}

void LstmStepper::Softmax() {
  const Eigen::MatrixXd& features = hidden_.empty() ? output_ : hidden_.back();
  for (int stream = 0; stream < streams_; ++stream) {
    auto dense = dense_.col(stream);
    dense = lstm_->dense_bias_;
    dense.noalias() += lstm_->dense_kernel_ * features.col(stream);
    auto probability = probability_.col(stream);
    probability = dense.head(lstm_->classes());
    probability.array() -= probability.maxCoeff();
    probability.array() -= std::log(probability.array().exp().sum());
    probability = probability.array().exp();
  }
}

}  // namespace tactus::internal
