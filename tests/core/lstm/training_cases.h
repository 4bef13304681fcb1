// File: training_cases.h
//
// Sequences to train on, and tensors of a network by name.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/lstm/network.h"
#include "core/lstm/sequence.h"
#include "tests/core/lstm/lstm_cases.h"

namespace tactus::internal {

// Holds the numbers that `views` show.
struct TrainingSet {
  std::vector<std::vector<float>> inputs;
  std::vector<std::vector<float>> targets;
  std::vector<LstmSequence> views;

  void Add(std::vector<float> x, int label, std::vector<float> y = {},
           float weight = 1) {
    inputs.push_back(std::move(x));
    targets.push_back(std::move(y));
    views.push_back({.inputs = inputs.back(),
                     .label = label,
                     .step_labels = {},
                     .targets = targets.back(),
                     .weight = weight});
  }
};

// Sequences of the lengths given, with targets for all but the last.
inline TrainingSet RandomTrainingSet(const LstmNetwork& network,
                                     const std::vector<int>& lengths,
                                     uint64_t seed) {
  Random random(seed);
  TrainingSet set;
  for (size_t i = 0; i < lengths.size(); ++i) {
    std::vector<float> x, y;
    for (const auto& row : MakeInputs(network.inputs(), lengths[i], seed + i)) {
      x.insert(x.end(), row.begin(), row.end());
      for (int r = 0; r < network.regressions; ++r) {
        y.push_back(static_cast<float>(random.Gaussian()));
      }
    }
    if (i + 1 == lengths.size()) y.clear();
    set.Add(std::move(x), static_cast<int>(random.Index(network.classes())),
            std::move(y), static_cast<float>(random.Uniform(0.5, 2)));
  }
  return set;
}

struct NamedTensor {
  std::string name;
  std::vector<float>* values;
};

inline std::vector<NamedTensor> Tensors(LstmNetwork& network) {
  std::vector<NamedTensor> tensors;
  for (size_t i = 0; i < network.layers.size(); ++i) {
    LstmLayer& layer = network.layers[i];
    const std::string name = "layer " + std::to_string(i);
    tensors.push_back({name + " kernel", &layer.kernel});
    tensors.push_back({name + " recurrent", &layer.recurrent});
    tensors.push_back({name + " bias", &layer.bias});
  }
  tensors.push_back({"dense kernel", &network.dense_kernel});
  tensors.push_back({"dense bias", &network.dense_bias});
  return tensors;
}

}  // namespace tactus::internal
