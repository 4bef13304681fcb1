#include "tests/core/lstm/torch.h"

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "gtest/gtest.h"
#include "tests/core/lstm/lstm_cases.h"

namespace tactus::internal {
namespace {

// Exit status of the scripts where torch cannot be imported.
constexpr int kNoTorch = 77;

// A temporary directory that is removed with the test.
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

int ExitStatus(const std::string& command) {
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

using nlohmann::json;

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
          {"regressions", network.regressions},
          {"dense_kernel", network.dense_kernel},
          {"dense_bias", network.dense_bias}};
}

std::string SourceDir() {
  const char* source = std::getenv("TACTUS_SOURCE_DIR");
  return source != nullptr ? source : ".";
}

std::optional<json> AskTorch(const std::string& script, const json& cases) {
  const TempDir dir;
  std::ofstream(dir.File("cases.json")) << cases;
  const int status = ExitStatus(
      "/usr/bin/python3 '" + SourceDir() + "/tests/core/lstm/" + script +
      "' '" + dir.File("cases.json") + "' '" + dir.File("answers.json") + "'");
  if (status == kNoTorch) {
    std::cout << "PyTorch (Debian: python3-torch) is absent; nothing to "
                 "compare with\n";
    return std::nullopt;
  }
  EXPECT_EQ(status, 0) << script;
  if (status != 0) return std::nullopt;
  return json::parse(std::ifstream(dir.File("answers.json")));
}

}  // namespace tactus::internal
