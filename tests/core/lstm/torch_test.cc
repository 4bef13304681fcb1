// The LSTM against PyTorch, which computes in double precision: nn.LSTM where
// it has the activations, and a cell written in torch for the others.
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "core/lstm/stepper.h"
#include "gtest/gtest.h"
#include "nlohmann/json.hpp"
#include "tests/core/lstm/lstm_cases.h"

namespace tactus {
namespace {

using nlohmann::json;

// Exit status of torch_reference.py where torch cannot be imported.
constexpr int kNoTorch = 77;

// A directory of its own that goes with the test.
class TempDir {
 public:
  TempDir() {
    std::string name =
        (std::filesystem::temp_directory_path() / "lstm-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) std::abort();
    path_ = name;
  }
  ~TempDir() { std::filesystem::remove_all(path_); }
  std::string File(const std::string& name) const {
    return (path_ / name).string();
  }

 private:
  std::filesystem::path path_;
};

json ToJson(const LstmNetwork& network) {
  json layers = json::array();
  for (const LstmLayer& layer : network.layers) {
    layers.push_back({{"inputs", layer.inputs},
                      {"cells", layer.cells},
                      {"kernel", layer.kernel},
                      {"recurrent", layer.recurrent},
                      {"bias", layer.bias}});
  }
  return {{"activation", Name(network.activation)},
          {"gate_activation", Name(network.gate_activation)},
          {"layers", layers},
          {"dense_kernel", network.dense_kernel},
          {"dense_bias", network.dense_bias}};
}

int ExitStatus(const std::string& command) {
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

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
  const TempDir dir;
  std::ofstream(dir.File("cases.json")) << cases;

  const char* source = std::getenv("TACTUS_SOURCE_DIR");
  const std::string script = std::string(source != nullptr ? source : ".") +
                             "/tests/core/lstm/torch_reference.py";
  const int status = ExitStatus("/usr/bin/python3 '" + script + "' '" +
                                dir.File("cases.json") + "' '" +
                                dir.File("answers.json") + "'");
  if (status == kNoTorch) {
    std::cout << "PyTorch (Debian: python3-torch) is absent; nothing to "
                 "compare with\n";
    return;
  }
  ASSERT_EQ(status, 0);
  const json answers = json::parse(std::ifstream(dir.File("answers.json")));
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
}  // namespace tactus
