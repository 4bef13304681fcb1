// interchange_samples write DIR: exports the samples of samples.h, with our
// answers, for other programs to check.
// interchange_samples write DIR BUNDLE: the same for the models of a bundle.
// interchange_samples read DIR: imports the files of DIR/torch.json and prints
// how far our posteriors are from those of the program that made them.
// check.sh runs both.
#include <cstdlib>
#include <iostream>

#include "core/base/limits.h"
#include "core/bundle/bundle.h"
#include "core/files/draft_file.h"
#include "core/files/file_bytes.h"
#include "core/interchange/hmm/hmm_json.h"
#include "core/interchange/hmm/hmm_npz.h"
#include "core/interchange/lstm/lstm_to_onnx.h"
#include "core/interchange/read_model_file.h"
#include "nlohmann/json.hpp"
#include "tests/core/interchange/hmm_scores.h"
#include "tests/core/interchange/peer_answers.h"
#include "tests/core/interchange/samples.h"

namespace tactus::internal {
namespace {

using nlohmann::json;

constexpr double kTolerance = 1e-5;

absl::Status Write(const std::vector<NetworkSample>& networks,
                   const Model& model, const std::string& folder) {
  const auto write = [&](const std::string& name, const std::string& bytes) {
    return WriteFileBytes(folder + "/" + name, bytes);
  };
  absl::Status status;
  json samples = json::object();
  for (const NetworkSample& sample : networks) {
    status.Update(write(sample.name + "-sequence.onnx",
                        *LstmsToOnnx(sample.model, OnnxGraph::kSequence)));
    status.Update(write(sample.name + "-step.onnx",
                        *LstmsToOnnx(sample.model, OnnxGraph::kStep)));
    samples[sample.name] = {
        {"inputs", sample.inputs},
        {"probability", Posteriors(sample.model.lstms, sample.inputs)}};
  }
  status.Update(write("networks.json", samples.dump()));
  status.Update(write("hmms.json", HmmsToJson(model, HmmJsonStyle::kHmmlearn)));
  status.Update(
      write("hmms-ghmm.json", HmmsToJson(model, HmmJsonStyle::kGhmm)));
  status.Update(write("hmms.npz", *HmmsToNpz(model)));
  json sequences = json::array();
  for (const HmmSequence& sequence : HmmSequences(model)) {
    sequences.push_back({{"observations", sequence.observations},
                         {"log_likelihood", sequence.log_likelihood}});
  }
  status.Update(write("hmm-scores.json", sequences.dump()));
  return status;
}

absl::Status WriteBundle(const std::string& path, const std::string& folder) {
  constexpr int kFrames = 500;
  const auto bytes = ReadFileBytes(path, limits::kMaxBundleBytes);
  if (!bytes.ok()) return bytes.status();
  const auto compiled = DecodeBundle(*bytes);
  if (!compiled.ok()) return compiled.status();
  const Model& model = (*compiled)->model();
  const int inputs = static_cast<int>(model.inputs.lstm.size());
  return Write({{"bundle", model, MakeInputs(inputs, kFrames, 71)}}, model,
               folder);
}

absl::Status Read(const std::string& folder) {
  double worst = 0;
  std::vector<PeerAnswer> answers = ReadPeerAnswers(folder + "/torch.json");
  for (PeerAnswer& answer : ReadPeerAnswers(folder + "/stacks.json")) {
    answers.push_back(std::move(answer));
  }
  for (const PeerAnswer& answer : answers) {
    // A file of weights alone has hidden layers with relu.
    const auto foreign =
        ReadModelFile(folder + "/" + answer.file,
                      {.dense_activation = HiddenActivation::kRelu});
    if (!foreign.ok()) return foreign.status();
    const double difference = Difference(foreign->lstms, answer);
    std::cout << answer.file << ": " << difference << "\n";
    worst = std::max(worst, difference);
  }
  if (worst <= kTolerance) return absl::OkStatus();
  return absl::InternalError(
      absl::StrCat("posteriors differ by up to ", worst));
}

}  // namespace
}  // namespace tactus::internal

int main(int argc, char** argv) {
  const std::string verb = argc >= 3 ? argv[1] : "";
  absl::Status status;
  if (verb == "write" && argc == 4) {
    status = tactus::internal::WriteBundle(argv[3], argv[2]);
  } else if (verb == "write" && argc == 3) {
    status = tactus::internal::Write(tactus::internal::NetworkSamples(),
                                     tactus::internal::HmmSample(), argv[2]);
  } else if (verb == "read" && argc == 3) {
    status = tactus::internal::Read(argv[2]);
  } else {
    std::cerr << "usage: interchange_samples write DIR [BUNDLE] | read DIR\n";
    return 2;
  }
  if (status.ok()) return EXIT_SUCCESS;
  std::cerr << status << "\n";
  return EXIT_FAILURE;
}
