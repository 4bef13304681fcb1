// Gradients and optimizers against PyTorch, which computes in double
// precision: from a file that it has written, and directly where it is
// installed.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "core/lstm/train.h"
#include "gtest/gtest.h"
#include "nlohmann/json.hpp"
#include "tests/core/lstm/torch.h"
#include "tests/core/lstm/training_cases.h"
#include "tests/reference/lstm/gradient.h"

namespace tactus::internal {
namespace {

using nlohmann::json;

LstmNetwork NetworkFrom(const json& from) {
  LstmNetwork network;
  for (const Activation activation : kActivations) {
    if (from["activation"] == Name(activation)) network.activation = activation;
  }
  for (const GateActivation gate : kGateActivations) {
    if (from["gate_activation"] == Name(gate)) network.gate_activation = gate;
  }
  for (const json& layer : from["layers"]) {
    network.layers.push_back({layer["inputs"], layer["cells"], layer["kernel"],
                              layer["recurrent"], layer["bias"]});
  }
  network.regressions = from["regressions"];
  network.dense_kernel = from["dense_kernel"].get<std::vector<float>>();
  network.dense_bias = from["dense_bias"].get<std::vector<float>>();
  return network;
}

TrainingSet BatchFrom(const json& from) {
  TrainingSet set;
  for (const json& sequence : from) {
    set.Add(sequence["inputs"], sequence["label"], sequence["targets"],
            sequence["weight"]);
  }
  return set;
}

LstmTrainOptions OptionsFrom(const json& from, int batch_size) {
  const json& loss = from["loss"];
  const json& optimizer = from["optimizer"];
  LstmTrainOptions options;
  options.epochs = optimizer["steps"];
  options.batch_size = batch_size;
  options.noise = {};
  options.optimizer.optimizer =
      optimizer["name"] == "adam" ? Optimizer::kAdam : Optimizer::kRmsProp;
  options.optimizer.learning_rate = optimizer["learning_rate"];
  options.optimizer.weight_decay = optimizer["weight_decay"];
  options.optimizer.gradient_clip = optimizer["gradient_clip"];
  options.loss.steps =
      loss["every_step"] ? LstmLoss::kEveryStep : LstmLoss::kLastStep;
  options.loss.first_step = loss["first_step"];
  options.loss.stride = loss["stride"];
  options.loss.label_smoothing = loss["label_smoothing"];
  options.loss.regression_weight = loss["regression_weight"];
  return options;
}

// Largest difference in any tensor, relative to the tensor's largest number.
double LargestError(LstmNetwork& got, const json& want) {
  const auto tensors = Tensors(got);
  EXPECT_EQ(tensors.size(), want.size());
  double worst = 0;
  for (size_t i = 0; i < tensors.size(); ++i) {
    const auto numbers = want[i].get<std::vector<double>>();
    EXPECT_EQ(tensors[i].values->size(), numbers.size()) << tensors[i].name;
    double largest = 0;
    double error = 0;
    for (size_t k = 0; k < numbers.size(); ++k) {
      largest = std::max(largest, std::abs(numbers[k]));
      error = std::max(error, std::abs(tensors[i].values->at(k) - numbers[k]));
    }
    EXPECT_GT(largest, 0) << tensors[i].name;
    worst = std::max(worst, error / largest);
  }
  return worst;
}

void ExpectAgreement(const json& from, const json& answer,
                     double weight_tolerance) {
  const LstmNetwork network = NetworkFrom(from["network"]);
  const TrainingSet batch = BatchFrom(from["batch"]);
  const LstmTrainOptions options =
      OptionsFrom(from, static_cast<int>(batch.views.size()));
  auto got = LossAndGradient(network, batch.views, options.loss);
  ASSERT_TRUE(got.ok()) << got.status();
  const double loss = answer["loss"];
  EXPECT_NEAR(got->loss, loss, 1e-6 * std::abs(loss));
  const double gradient = LargestError(got->gradient, answer["gradient"]);
  EXPECT_LE(gradient, 1e-5);
  auto trained = TrainLstm({.network = network}, batch.views, {}, options);
  ASSERT_TRUE(trained.ok()) << trained.status();
  const double weights = LargestError(trained->network, answer["trained"]);
  EXPECT_LE(weights, weight_tolerance);
  std::cout << Name(network.activation) << ", " << Name(network.gate_activation)
            << ", " << network.parameter_count()
            << " parameters: gradient within " << gradient
            << " of PyTorch, trained weights within " << weights << "\n";
}

TEST(LstmTorchTrainingTest, AgreesWithWhatPyTorchWrote) {
  const json golden = json::parse(
      std::ifstream(SourceDir() + "/tests/golden/lstm_training.json"));
  ASSERT_EQ(golden["cases"].size(), 4u);
  for (const json& from : golden["cases"]) {
    ExpectAgreement(from, from["answer"], 1e-5);
  }
}

json ToJson(const TrainingSet& set) {
  json batch = json::array();
  for (size_t i = 0; i < set.views.size(); ++i) {
    batch.push_back({{"inputs", set.inputs[i]},
                     {"label", set.views[i].label},
                     {"targets", set.targets[i]},
                     {"weight", set.views[i].weight}});
  }
  return batch;
}

TEST(LstmTorchTrainingTest, AgreesWithPyTorchOnThePapersNetwork) {
  json cases = json::array();
  for (const bool every : {false, true}) {
    const LstmNetwork network =
        RandomNetwork(3, {50, 50}, 4, Activation::kTanh,
                      GateActivation::kSigmoid, 3, /*forget_bias=*/1,
                      /*regressions=*/1);
    const TrainingSet set = RandomTrainingSet(network, {50, 20, 50, 33}, 4);
    cases.push_back({{"network", ToJson(network)},
                     {"batch", ToJson(set)},
                     {"loss",
                      {{"every_step", every},
                       {"first_step", 10},
                       {"stride", 1},
                       {"label_smoothing", 0.05},
                       {"regression_weight", 0.5}}},
                     {"optimizer",
                      {{"name", every ? "adam" : "rmsprop"},
                       {"learning_rate", 1e-3},
                       {"weight_decay", 0},
                       {"gradient_clip", 1},
                       {"steps", 2}}}});
  }
  const auto answers = AskTorch("torch_training.py", cases);
  if (!answers) return;
  for (size_t i = 0; i < cases.size(); ++i) {
    // Optimizers divide by the root of the mean square: slopes near epsilon
    // magnify what float rounds off.
    ExpectAgreement(cases[i], answers->at(i), 1e-4);
  }
}

}  // namespace
}  // namespace tactus::internal
