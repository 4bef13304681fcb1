#include "core/lstm/stepper.h"

#include <algorithm>
#include <cmath>

#include "core/base/status_macros.h"

namespace tactus {
namespace {

// Far beyond saturation, and small enough that no sum overflows.
constexpr double kMaxInput = 1e20;

using RowMajor =
    Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Values = Eigen::Ref<Eigen::ArrayXf>;

void Activate(Activation activation, Values values) {
  switch (activation) {
    case Activation::kTanh:
      // Within 2e-7; Eigen's tanh is only within 3.5e-7.
      values = 1.0F - 2.0F / ((2.0F * values).exp() + 1.0F);
      return;
    case Activation::kSoftsign:
      values /= values.abs() + 1;
      return;
  }
}

void ActivateGates(GateActivation activation, Values values) {
  switch (activation) {
    case GateActivation::kSigmoid:
      values = 1.0F / (1.0F + (-values).exp());
      return;
    case GateActivation::kHardSigmoid:
      values = (values * 0.2F + 0.5F).max(0.0F).min(1.0F);
      return;
  }
}

// Rows i, f, c, o to i, f, o, c.
template <typename Matrix>
void GatesTogether(Matrix& matrix, int cells) {
  matrix.middleRows(2 * cells, cells).swap(matrix.bottomRows(cells));
}

}  // namespace

absl::StatusOr<CompiledLstm> CompiledLstm::Create(const LstmNetwork& network) {
  TACTUS_RETURN_IF_ERROR(Validate(network));
  CompiledLstm lstm;
  lstm.activation_ = network.activation;
  lstm.gate_activation_ = network.gate_activation;
  for (const LstmLayer& from : network.layers) {
    const int rows = 4 * from.cells;
    Layer& to = lstm.layers_.emplace_back();
    to.inputs = from.inputs;
    to.cells = from.cells;
    to.weights.resize(rows, from.inputs + from.cells);
    to.weights.leftCols(from.inputs) =
        Eigen::Map<const RowMajor>(from.kernel.data(), rows, from.inputs);
    to.weights.rightCols(from.cells) =
        Eigen::Map<const RowMajor>(from.recurrent.data(), rows, from.cells);
    to.bias = Eigen::Map<const Eigen::VectorXf>(from.bias.data(), rows);
    GatesTogether(to.weights, from.cells);
    GatesTogether(to.bias, from.cells);
  }
  const auto outputs = static_cast<int>(network.dense_bias.size());
  const int cells = network.layers.back().cells;
  lstm.regressions_ = network.regressions;
  lstm.dense_kernel_ =
      Eigen::Map<const RowMajor>(network.dense_kernel.data(), outputs, cells)
          .cast<double>();
  lstm.dense_bias_ =
      Eigen::Map<const Eigen::VectorXf>(network.dense_bias.data(), outputs)
          .cast<double>();
  return lstm;
}

LstmStepper::LstmStepper(const CompiledLstm& lstm) : lstm_(&lstm) {
  for (const CompiledLstm::Layer& layer : lstm.layers_) {
    State& state = states_.emplace_back();
    state.input_output.resize(layer.inputs + layer.cells);
    state.cell.resize(layer.cells);
    state.gates.resize(4 * layer.cells);
    state.squashed.resize(layer.cells);
  }
  output_.resize(lstm.layers_.back().cells);
  dense_.resize(lstm.dense_bias_.size());
  log_probability_.resize(lstm.classes());
  probability_.resize(lstm.classes());
  Reset();
}

void LstmStepper::Reset() {
  for (State& state : states_) {
    state.input_output.setZero();
    state.cell.setZero();
  }
  dense_.setZero();
  log_probability_.setConstant(-std::log(double(lstm_->classes())));
  probability_.setConstant(1.0 / lstm_->classes());
}

void LstmStepper::Step(std::span<const double> input) {
  for (int i = 0; i < lstm_->inputs(); ++i) {
    states_.front().input_output[i] =
        static_cast<float>(std::clamp(input[i], -kMaxInput, kMaxInput));
  }
  for (size_t i = 0; i < states_.size(); ++i) {
    const CompiledLstm::Layer& layer = lstm_->layers_[i];
    StepLayer(layer, states_[i]);
    const auto output = states_[i].input_output.tail(layer.cells);
    if (i + 1 < states_.size()) {
      states_[i + 1].input_output.head(layer.cells) = output;
    } else {
      output_ = output.cast<double>();
    }
  }
  Softmax();
}

void LstmStepper::StepLayer(const CompiledLstm::Layer& layer,
                            State& state) const {
  const int cells = layer.cells;
  state.gates = layer.bias;
  state.gates.noalias() += layer.weights * state.input_output;
  ActivateGates(lstm_->gate_activation_, state.gates.head(3 * cells).array());
  Activate(lstm_->activation_, state.gates.tail(cells).array());
  const auto input_gate = state.gates.segment(0, cells).array();
  const auto forget_gate = state.gates.segment(cells, cells).array();
  const auto output_gate = state.gates.segment(2 * cells, cells).array();
  const auto candidate = state.gates.segment(3 * cells, cells).array();
  state.cell.array() =
      forget_gate * state.cell.array() + input_gate * candidate;
  state.squashed = state.cell;
  Activate(lstm_->activation_, state.squashed.array());
  state.input_output.tail(cells).array() = output_gate * state.squashed.array();
}

void LstmStepper::Softmax() {
  dense_ = lstm_->dense_bias_;
  dense_.noalias() += lstm_->dense_kernel_ * output_;
  log_probability_ = dense_.head(lstm_->classes());
  log_probability_.array() -= log_probability_.maxCoeff();
  log_probability_.array() -= std::log(log_probability_.array().exp().sum());
  probability_ = log_probability_.array().exp();
}

}  // namespace tactus
