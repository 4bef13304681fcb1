// The LSTM against PyTorch, which computes in double precision: nn.LSTM where
// it has the activations, and a cell written in torch for the others.
#include "tests/core/lstm/torch.h"

#include <iostream>
#include <vector>

#include "core/lstm/stepper.h"
#include "gtest/gtest.h"
#include "nlohmann/json.hpp"
#include "tests/core/lstm/lstm_cases.h"

namespace tactus::internal {
namespace {

using nlohmann::json;

TEST(LstmTorchTest, AgreesWithPyTorch) {
  std::vector<LstmNetwork> networks;
  for (Activation activation : kActivations) {
    for (GateActivation gate : kGateActivations) {
      networks.push_back(MakeNetwork(2, {50, 50}, 4, activation, gate, 11));
      networks.push_back(MakeNetwork(3, {9, 5, 13}, 6, activation, gate, 12));
    }
  }
  json cases = json::array();
  for (const LstmNetwork& network : networks) {
    cases.push_back({{"network", ToJson(network)},
                     {"inputs", MakeInputs(network.inputs(), 500, 13)}});
  }
  const auto answered = AskTorch("torch_reference.py", cases);
  if (!answered) return;
  const json& answers = *answered;
  ASSERT_EQ(answers.size(), networks.size());
  for (size_t i = 0; i < networks.size(); ++i) {
    auto lstm = CompiledLstm::Create(networks[i]);
    ASSERT_TRUE(lstm.ok()) << lstm.status();
    LstmStepper stepper(*lstm);
    const auto got = RunAll(
        stepper, cases[i]["inputs"].get<std::vector<std::vector<double>>>());
    const double difference = LargestDifference(
        got, answers[i].get<std::vector<std::vector<double>>>());
    std::cout << Name(networks[i].activation) << ", "
              << Name(networks[i].gate_activation) << ", "
              << networks[i].parameter_count() << " parameters: within "
              << difference << " of PyTorch\n";
    EXPECT_LE(difference, 1e-5);
  }
}

}  // namespace
}  // namespace tactus::internal
