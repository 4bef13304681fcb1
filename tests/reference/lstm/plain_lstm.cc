#include "tests/reference/lstm/plain_lstm.h"

#include <algorithm>
#include <cmath>

namespace tactus::internal {
namespace {

double Gate(GateActivation activation, double x) {
  if (activation == GateActivation::kSigmoid) return 1 / (1 + std::exp(-x));
  return std::max(0.0, std::min(1.0, 0.2 * x + 0.5));
}

double Squash(Activation activation, double x) {
  if (activation == Activation::kTanh) return std::tanh(x);
  return x / (1 + std::abs(x));
}

// Row `row` of the layer before its activation.
double RowSum(const LstmLayer& layer, int row, const std::vector<double>& x,
              const std::vector<double>& h) {
  double sum = layer.bias[row];
  for (int j = 0; j < layer.inputs; ++j) {
    sum += layer.kernel[row * layer.inputs + j] * x[j];
  }
  for (int j = 0; j < layer.cells; ++j) {
    sum += layer.recurrent[row * layer.cells + j] * h[j];
  }
  return sum;
}

void StepLayer(const LstmNetwork& network, const LstmLayer& layer,
               const std::vector<double>& x, std::vector<double>& h,
               std::vector<double>& c) {
  const std::vector<double> previous = h;
  const int cells = layer.cells;
  for (int k = 0; k < cells; ++k) {
    const auto row = [&](int gate) {
      return RowSum(layer, gate * cells + k, x, previous);
    };
    const double i = Gate(network.gate_activation, row(0));
    const double f = Gate(network.gate_activation, row(1));
    const double g = Squash(network.activation, row(2));
    const double o = Gate(network.gate_activation, row(3));
    c[k] = f * c[k] + i * g;
    h[k] = o * Squash(network.activation, c[k]);
  }
}

std::vector<double> StepHidden(const HiddenLayer& layer,
                               const std::vector<double>& x) {
  std::vector<double> y(layer.bias.begin(), layer.bias.end());
  for (int k = 0; k < layer.units; ++k) {
    for (int j = 0; j < layer.inputs; ++j) {
      y[k] += layer.kernel[k * layer.inputs + j] * x[j];
    }
    if (layer.activation == HiddenActivation::kRelu && y[k] < 0) y[k] = 0;
    if (layer.activation == HiddenActivation::kTanh) y[k] = std::tanh(y[k]);
    if (layer.activation == HiddenActivation::kSigmoid) {
      y[k] = 1 / (1 + std::exp(-y[k]));
    }
  }
  return y;
}

std::vector<double> Dense(const LstmNetwork& network,
                          const std::vector<double>& h) {
  std::vector<double> result(network.dense_bias.begin(),
                             network.dense_bias.end());
  for (size_t k = 0; k < result.size(); ++k) {
    for (size_t j = 0; j < h.size(); ++j) {
      result[k] += network.dense_kernel[k * h.size() + j] * h[j];
    }
  }
  return result;
}

void Softmax(std::vector<double>& values) {
  const double largest = *std::max_element(values.begin(), values.end());
  double sum = 0;
  for (double& value : values) sum += value = std::exp(value - largest);
  for (double& value : values) value /= sum;
}

}  // namespace

std::vector<std::vector<double>> PlainOutputs(
    const LstmNetwork& network,
    const std::vector<std::vector<double>>& inputs) {
  std::vector<std::vector<double>> h, c, results;
  for (const LstmLayer& layer : network.layers) {
    h.emplace_back(layer.cells);
    c.emplace_back(layer.cells);
  }
  for (std::vector<double> x : inputs) {
    for (size_t i = 0; i < network.layers.size(); ++i) {
      StepLayer(network, network.layers[i], x, h[i], c[i]);
      x = h[i];
    }
    for (const HiddenLayer& layer : network.hidden) x = StepHidden(layer, x);
    results.push_back(Dense(network, x));
  }
  return results;
}

std::vector<std::vector<double>> PlainLstm(
    const LstmNetwork& network,
    const std::vector<std::vector<double>>& inputs) {
  auto results = PlainOutputs(network, inputs);
  for (std::vector<double>& result : results) {
    result.resize(network.classes());
    Softmax(result);
  }
  return results;
}

namespace {

double PlainStepLoss(const LstmNetwork& network, const LstmSequence& sequence,
                     const std::vector<double>& outputs, int t,
                     const LstmLossOptions& options) {
  const int classes = network.classes();
  const int regressions = network.regressions;
  std::vector<double> probability(outputs.begin(), outputs.begin() + classes);
  Softmax(probability);
  double loss = 0;
  for (int k = 0; k < classes; ++k) {
    const double want = options.label_smoothing / classes +
                        (1 - options.label_smoothing) * (k == sequence.label);
    loss -= want * std::log(probability[k]);
  }
  if (sequence.targets.empty()) return loss;
  for (int r = 0; r < regressions; ++r) {
    const double error =
        sequence.targets[t * regressions + r] - outputs[classes + r];
    const double s = outputs[classes + regressions + r];
    loss += options.regression_weight * 0.5 * (s + error * error / std::exp(s));
  }
  return loss;
}

}  // namespace

double PlainLoss(const LstmNetwork& network,
                 std::span<const LstmSequence> batch,
                 const LstmLossOptions& options) {
  double total = 0;
  for (const LstmSequence& sequence : batch) {
    std::vector<std::vector<double>> inputs;
    const auto x = sequence.inputs;
    for (size_t at = 0; at < x.size(); at += network.inputs()) {
      inputs.emplace_back(x.begin() + at, x.begin() + at + network.inputs());
    }
    const auto outputs = PlainOutputs(network, inputs);
    const int last = static_cast<int>(inputs.size()) - 1;
    double sum = 0;
    int count = 0;
    const auto add = [&](int t) {
      sum += PlainStepLoss(network, sequence, outputs[t], t, options);
      ++count;
    };
    if (options.steps == LstmLoss::kEveryStep) {
      for (int t = options.first_step; t < last; t += options.stride) add(t);
    }
    add(last);
    total += sequence.weight * sum / count;
  }
  return total / static_cast<double>(batch.size());
}

}  // namespace tactus::internal
