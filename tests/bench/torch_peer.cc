#include "tests/bench/torch_peer.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "nlohmann/json.hpp"

namespace tactus::internal::client {
namespace {

// Reads commands, one per line, and answers each with one line.
constexpr char kScript[] = R"py(
import json, sys, time
try:
    import torch
except ImportError:
    sys.exit(77)
torch.set_num_threads(1)


class Network(torch.nn.Module):
    def __init__(self, case):
        super().__init__()
        layers = case["layers"]
        cells = layers[0]["cells"]
        self.lstm = torch.nn.LSTM(layers[0]["inputs"], cells, len(layers))
        self.dense = torch.nn.Linear(cells, len(case["dense_bias"]))
        self.parts = []
        with torch.no_grad():
            for i, layer in enumerate(layers):
                for name, key in (("weight_ih", "kernel"),
                                  ("weight_hh", "recurrent"),
                                  ("bias_ih", "bias")):
                    self.put(getattr(self.lstm, f"{name}_l{i}"), layer[key])
                # Ours has one bias.
                other = getattr(self.lstm, f"bias_hh_l{i}")
                other.zero_()
                other.requires_grad_(False)
            self.put(self.dense.weight, case["dense_kernel"])
            self.put(self.dense.bias, case["dense_bias"])

    def put(self, parameter, values):
        parameter.copy_(torch.tensor(values).reshape(parameter.shape))
        self.parts.append(parameter)


class Stepping:
    def __init__(self, case):
        self.network = Network(case).eval()
        shape = (case["steps"], 1, case["batch"], -1)
        self.frames = list(torch.tensor(case["inputs"]).reshape(shape))

    def repeat(self):
        results = []
        state = None
        with torch.inference_mode():
            for frame in self.frames:
                output, state = self.network.lstm(frame, state)
                dense = self.network.dense(output[0])
                results.append(torch.softmax(dense, 1))
        return results

    def answer(self):
        return torch.stack(self.repeat())


class Training:
    def __init__(self, case):
        self.network = Network(case).train()
        shape = (case["steps"], case["batch"], -1)
        self.inputs = torch.tensor(case["inputs"]).reshape(shape)
        self.labels = torch.tensor(case["labels"])
        self.optimizer = torch.optim.RMSprop(
            self.network.parts, lr=1e-3, alpha=0.9, eps=1e-7)

    def gradient(self):
        self.optimizer.zero_grad()
        output = self.network.lstm(self.inputs)[0][-1]
        torch.nn.functional.cross_entropy(
            self.network.dense(output), self.labels).backward()

    def repeat(self):
        self.gradient()
        self.optimizer.step()

    def answer(self):
        self.gradient()
        return torch.cat([part.grad.flatten() for part in self.network.parts])


print("ready", flush=True)
for line in sys.stdin:
    command, _, path = line.strip().partition(" ")
    if command == "load":
        with open(path) as file:
            case = json.load(file)
        work = Training(case) if case["train"] else Stepping(case)
        print("loaded", flush=True)
    elif command == "repeat":
        start = time.process_time()
        work.repeat()
        print(time.process_time() - start, flush=True)
    else:
        print(json.dumps(work.answer().flatten().tolist()), flush=True)
)py";

nlohmann::json ToJson(const TorchCase& work) {
  nlohmann::json layers = nlohmann::json::array();
  for (const LstmLayer& layer : work.network->layers) {
    layers.push_back({{"inputs", layer.inputs},
                      {"cells", layer.cells},
                      {"kernel", layer.kernel},
                      {"recurrent", layer.recurrent},
                      {"bias", layer.bias}});
  }
  return {{"layers", layers},
          {"dense_kernel", work.network->dense_kernel},
          {"dense_bias", work.network->dense_bias},
          {"steps", work.steps},
          {"batch", work.batch},
          {"inputs", work.inputs},
          {"train", work.train},
          {"labels", work.labels}};
}

}  // namespace

absl::StatusOr<std::unique_ptr<TorchPeer>> TorchPeer::Start() {
  // Debian's torch belongs to Debian's Python, which need not be the first.
  for (const char* python : {"/usr/bin/python3", "python3"}) {
    std::unique_ptr<TorchPeer> peer(new TorchPeer());
    TACTUS_RETURN_IF_ERROR(peer->Spawn(python));
    if (peer->Receive() == "ready") return peer;
  }
  return nullptr;
}

absl::Status TorchPeer::Spawn(const std::string& python) {
  int commands[2], answers[2];
  if (pipe2(commands, O_CLOEXEC) != 0 || pipe2(answers, O_CLOEXEC) != 0) {
    return IoError("pipe", std::strerror(errno));
  }
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, commands[0], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, answers[1], STDOUT_FILENO);
  std::string arguments[] = {python, "-c", kScript};
  char* argv[] = {arguments[0].data(), arguments[1].data(), arguments[2].data(),
                  nullptr};
  if (posix_spawnp(&pid_, argv[0], &actions, nullptr, argv, environ) != 0) {
    pid_ = -1;
  }
  posix_spawn_file_actions_destroy(&actions);
  close(commands[0]);
  close(answers[1]);
  to_ = fdopen(commands[1], "w");
  from_ = fdopen(answers[0], "r");
  return absl::OkStatus();
}

TorchPeer::~TorchPeer() {
  if (to_ != nullptr) std::fclose(to_);
  if (from_ != nullptr) std::fclose(from_);
  if (pid_ >= 0) waitpid(pid_, nullptr, 0);
}

absl::Status TorchPeer::Load(const TorchCase& work) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() /
      absl::StrCat("tactus-torch-", getpid(), ".json");
  std::ofstream file(path);
  file << ToJson(work);
  file.close();
  Send(absl::StrCat("load ", path.string(), "\n"));
  const bool loaded = file && Receive() == "loaded";
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
  return loaded ? absl::OkStatus()
                : IoError(path.string(), "PyTorch cannot load it");
}

double TorchPeer::Repeat() {
  Send("repeat\n");
  double seconds = 0;
  return absl::SimpleAtod(Receive(), &seconds)
             ? seconds
             : std::numeric_limits<double>::quiet_NaN();
}

absl::StatusOr<std::vector<double>> TorchPeer::Answer() {
  Send("answer\n");
  const auto json = nlohmann::json::parse(Receive(), nullptr, false);
  if (!json.is_array()) return IoError("PyTorch", "gave no answer");
  return json.get<std::vector<double>>();
}

void TorchPeer::Send(absl::string_view line) {
  std::fwrite(line.data(), 1, line.size(), to_);
  std::fflush(to_);
}

std::string TorchPeer::Receive() {
  std::string line;
  for (int c = std::getc(from_); c != EOF && c != '\n'; c = std::getc(from_)) {
    line.push_back(static_cast<char>(c));
  }
  return line;
}

}  // namespace tactus::internal::client
