// File: samples.h
//
// Models and sequences that are exchanged with other programs: by
// interchange_test with answers that were recorded, by check.sh with the
// programs themselves. Test-only; deterministic.
//
//   for (const NetworkSample& sample : NetworkSamples()) {
//     LstmsToOnnx(sample.model, OnnxGraph::kSequence);
//   }
#pragma once

#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/classify/model.h"
#include "core/interchange/model/foreign_model.h"
#include "tests/core/hmm/random_model.h"
#include "tests/core/lstm/lstm_cases.h"
#include "tests/support/small_model.h"

namespace tactus::internal {

// [T][inputs] or [T][classes].
using Rows = std::vector<std::vector<double>>;

struct NetworkSample {
  std::string name;
  Model model;
  Rows inputs;
};

inline Model ModelOf(std::vector<LstmNetwork> networks) {
  Model model = testing::SmallModel();
  for (int i = 0; i < networks.front().inputs(); ++i) {
    model.inputs.lstm.push_back(
        {Cue::kForce, 0.5 * i, 0.1 * i, 1.0 + i, i == 0 ? 5.0 : HUGE_VAL});
  }
  model.inputs.lstm_steps = {5, 20};
  testing::AddLstmCalibration(model.calibration);
  model.lstms = std::move(networks);
  return model;
}

// Each pair of activations, with one to three layers, and a mean of three
// networks.
inline std::vector<NetworkSample> NetworkSamples() {
  constexpr int kFrames = 40;
  std::vector<NetworkSample> samples;
  const std::vector<std::vector<int>> cells = {{7}, {5, 4}, {6, 3, 5}, {8, 8}};
  size_t shape = 0;
  for (const Activation activation : kActivations) {
    for (const GateActivation gate : kGateActivations) {
      const int inputs = 2 + static_cast<int>(shape);
      samples.push_back({Name(activation) + "-" + Name(gate),
                         ModelOf({MakeNetwork(inputs, cells[shape], 4,
                                              activation, gate, 21 + shape)}),
                         MakeInputs(inputs, kFrames, 31 + shape)});
      ++shape;
    }
  }
  std::vector<LstmNetwork> networks;
  for (const uint64_t seed : {41, 42, 43}) {
    networks.push_back(MakeNetwork(3, {5, 4}, 4, Activation::kTanh,
                                   GateActivation::kSigmoid, seed));
  }
  samples.push_back({"mean-of-three", ModelOf(std::move(networks)),
                     MakeInputs(3, kFrames, 44)});
  return samples;
}

// Posteriors of the mean of `networks` after each step.
inline Rows Posteriors(const std::vector<LstmNetwork>& networks,
                       const Rows& inputs) {
  Rows mean;
  for (const LstmNetwork& network : networks) {
    const CompiledLstm lstm = *CompiledLstm::Create(network);
    LstmStepper stepper(lstm);
    const Rows rows = RunAll(stepper, inputs);
    if (mean.empty())
      mean.assign(rows.size(), Rows::value_type(rows[0].size()));
    for (size_t t = 0; t < rows.size(); ++t) {
      for (size_t k = 0; k < rows[t].size(); ++k) {
        mean[t][k] += rows[t][k] / static_cast<double>(networks.size());
      }
    }
  }
  return mean;
}

// HMMs of three dimensions: each form of covariance, left-right and not, and a
// class with two HMMs.
inline Model HmmSample() {
  Random random(51);
  Model model = testing::SmallModel();
  model.hmms.clear();
  model.inputs.hmm = {
      {Cue::kForce, 0.01}, {Cue::kArea}, {Cue::kMotion, 0, 0, 9}};
  const auto hmm = [&](int states, CovarianceType type, bool left_right) {
    return RandomModel(states, 3, type, left_right, random);
  };
  model.hmms.push_back({{0.0}, {hmm(4, CovarianceType::kFull, true)}});
  model.hmms.push_back({{0.0}, {hmm(3, CovarianceType::kDiagonal, false)}});
  model.hmms.push_back({{0.0}, {hmm(1, CovarianceType::kSpherical, false)}});
  model.hmms.push_back({{std::log(0.25), std::log(0.75)},
                        {hmm(5, CovarianceType::kFull, false),
                         hmm(2, CovarianceType::kDiagonal, true)}});
  return model;
}

// A sequence of `frames` observations of the first HMM of class `k`, T x 3.
inline std::vector<double> HmmObservations(const Model& model, size_t k,
                                           int frames) {
  Random random(61 + k);
  return RandomObservations(model.hmms[k].components.front(), frames, random);
}

}  // namespace tactus::internal
