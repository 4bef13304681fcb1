// File: lstm_cases.h
//
// Random networks and sequences on which the LSTM is compared with others.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/lstm/network.h"
#include "core/lstm/stepper.h"

namespace tactus::internal {

inline constexpr Activation kActivations[] = {Activation::kTanh,
                                              Activation::kSoftsign};
inline constexpr GateActivation kGateActivations[] = {
    GateActivation::kSigmoid, GateActivation::kHardSigmoid};

inline std::string Name(Activation activation) {
  return activation == Activation::kTanh ? "tanh" : "softsign";
}

inline std::string Name(GateActivation activation) {
  return activation == GateActivation::kSigmoid ? "sigmoid" : "hard_sigmoid";
}

// Weights `gain` times as large as those a network starts from, and biases
// that are not 0: with a gain above 1 the cells swing as trained ones do.
inline LstmNetwork MakeNetwork(int inputs, const std::vector<int>& cells,
                               int classes, Activation activation,
                               GateActivation gate, uint64_t seed,
                               float gain = 2) {
  LstmNetwork network =
      RandomNetwork(inputs, cells, classes, activation, gate, seed);
  Random random(seed + 1);
  const auto enlarge = [&](std::vector<float>& weights) {
    for (float& weight : weights) weight *= gain;
  };
  const auto shift = [&](std::vector<float>& biases) {
    for (float& bias : biases) bias += static_cast<float>(random.Gaussian());
  };
  for (LstmLayer& layer : network.layers) {
    enlarge(layer.kernel);
    enlarge(layer.recurrent);
    shift(layer.bias);
  }
  enlarge(network.dense_kernel);
  shift(network.dense_bias);
  return network;
}

// Adds a hidden layer, and a new output layer behind it.
inline void AddHidden(int units, HiddenActivation activation, uint64_t seed,
                      LstmNetwork& network) {
  Random random(seed);
  const auto gaussians = [&](size_t count) {
    std::vector<float> values(count);
    for (float& value : values) value = static_cast<float>(random.Gaussian());
    return values;
  };
  HiddenLayer layer;
  layer.inputs = network.features();
  layer.units = units;
  layer.activation = activation;
  layer.kernel = gaussians(size_t(units) * layer.inputs);
  layer.bias = gaussians(units);
  network.hidden.push_back(std::move(layer));
  network.dense_kernel = gaussians(network.dense_bias.size() * units);
}

// [steps][inputs], slowly wandering with noise on top, of a few units' size.
inline std::vector<std::vector<double>> MakeInputs(int inputs, int steps,
                                                   uint64_t seed) {
  Random random(seed);
  std::vector<double> level(inputs);
  std::vector<std::vector<double>> result;
  for (int t = 0; t < steps; ++t) {
    std::vector<double>& row = result.emplace_back();
    for (double& value : level) {
      value = 0.99 * value + 0.3 * random.Gaussian();
      row.push_back(value + 0.1 * random.Gaussian());
    }
  }
  return result;
}

// Probability per class after each step, [T][classes].
inline std::vector<std::vector<double>> RunAll(
    LstmStepper& stepper, const std::vector<std::vector<double>>& inputs) {
  std::vector<std::vector<double>> results;
  for (const std::vector<double>& input : inputs) {
    stepper.Step(input);
    const auto probability = stepper.probability();
    results.emplace_back(probability.begin(), probability.end());
  }
  return results;
}

inline double LargestDifference(const std::vector<std::vector<double>>& a,
                                const std::vector<std::vector<double>>& b) {
  double largest = a.size() == b.size() ? 0 : HUGE_VAL;
  for (size_t t = 0; t < std::min(a.size(), b.size()); ++t) {
    for (size_t k = 0; k < a[t].size(); ++k) {
      largest = std::max(largest, std::abs(a[t][k] - b[t].at(k)));
    }
  }
  return largest;
}

}  // namespace tactus::internal
