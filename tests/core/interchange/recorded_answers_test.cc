// Our posteriors and likelihoods against those that other programs gave.
// check.sh asks the programs themselves.
#include <cmath>
#include <fstream>

#include "core/interchange/hmm/hmm_json.h"
#include "core/interchange/hmm/hmm_npz.h"
#include "core/interchange/lstm/lstm_from_onnx.h"
#include "core/interchange/lstm/lstm_to_onnx.h"
#include "core/interchange/lstm/onnx_subset.pb.h"
#include "core/interchange/read_model_file.h"
#include "gtest/gtest.h"
#include "nlohmann/json.hpp"
#include "tests/bench/ghmm_peer.h"
#include "tests/core/interchange/golden.h"
#include "tests/core/interchange/hmm_scores.h"
#include "tests/core/interchange/peer_answers.h"
#include "tests/core/interchange/samples.h"

namespace tactus::internal {
namespace {

using nlohmann::json;

constexpr double kPosterior = 1e-5;
constexpr double kLikelihood = 1e-9;

// Apart from the version of Tactus.
std::string WithoutVersion(const std::string& bytes) {
  onnx::ModelProto model;
  EXPECT_TRUE(model.ParseFromString(bytes));
  model.clear_producer_version();
  return model.SerializeAsString();
}

TEST(RecordedAnswersTest, OnnxRuntimeGivesOurPosteriors) {
  const json recorded = json::parse(Golden("onnxruntime.json"));
  for (const NetworkSample& sample : NetworkSamples()) {
    // What the runtime was given is what we export.
    const auto exported = [&](OnnxGraph graph) {
      return WithoutVersion(*LstmsToOnnx(sample.model, graph));
    };
    EXPECT_EQ(exported(OnnxGraph::kSequence),
              WithoutVersion(Golden(sample.name + "-sequence.onnx")));
    EXPECT_EQ(exported(OnnxGraph::kStep),
              WithoutVersion(Golden(sample.name + "-step.onnx")));
    const Rows ours = Posteriors(sample.model.lstms, sample.inputs);
    for (const char* graph : {"sequence", "step"}) {
      const Rows theirs = recorded["answers"][sample.name][graph].get<Rows>();
      EXPECT_LE(LargestDifference(ours, theirs), kPosterior)
          << sample.name << " " << graph;
    }
  }
}

TEST(RecordedAnswersTest, PyTorchAndKerasFilesGiveTheirPosteriors) {
  const auto answers = ReadPeerAnswers(GoldenPath("torch.json"));
  ASSERT_EQ(answers.size(), 7u);
  for (const PeerAnswer& answer : answers) {
    const auto foreign = ReadModelFile(GoldenPath(answer.file));
    ASSERT_TRUE(foreign.ok()) << foreign.status();
    EXPECT_LE(Difference(foreign->lstms, answer), kPosterior) << answer.file;
  }
}

// Hidden layers, batch normalization and dropout, as numpy computes them.
TEST(RecordedAnswersTest, StacksOfLayersGiveNumpysPosteriors) {
  const auto answers = ReadPeerAnswers(GoldenPath("stacks.json"));
  ASSERT_EQ(answers.size(), 6u);
  for (const PeerAnswer& answer : answers) {
    const auto foreign = ReadModelFile(
        GoldenPath(answer.file), {.dense_activation = HiddenActivation::kRelu});
    ASSERT_TRUE(foreign.ok()) << foreign.status();
    EXPECT_LE(Difference(foreign->lstms, answer), kPosterior) << answer.file;
    // And once more through our own files.
    Model model = ModelOf(foreign->lstms);
    for (const OnnxGraph graph : {OnnxGraph::kSequence, OnnxGraph::kStep}) {
      if (model.classes() != foreign->lstms[0].classes()) continue;
      const auto again = LstmsFromOnnx("x.onnx", *LstmsToOnnx(model, graph));
      ASSERT_TRUE(again.ok()) << answer.file << again.status();
      EXPECT_EQ(Posteriors(again->lstms, answer.inputs),
                Posteriors(foreign->lstms, answer.inputs))
          << answer.file;
    }
  }
}

TEST(RecordedAnswersTest, PomegranateGivesOurLikelihoods) {
  const json recorded = json::parse(Golden("pomegranate.json"));
  const auto read = HmmsFromJson("hmms.json", Golden("hmms.json"));
  ASSERT_TRUE(read.ok()) << read.status();
  const auto sequences = HmmSequences(HmmSample());
  ASSERT_EQ(sequences.size(), recorded["log_likelihood"].size());
  for (size_t i = 0; i < sequences.size(); ++i) {
    for (size_t k = 0; k < read->hmms.size(); ++k) {
      const double theirs = recorded["log_likelihood"][i][k];
      const double ours =
          LogLikelihood(read->hmms[k].mixture, sequences[i].observations);
      EXPECT_NEAR(ours, theirs, kLikelihood * std::abs(theirs));
      EXPECT_NEAR(sequences[i].log_likelihood[k], theirs,
                  kLikelihood * std::abs(theirs));
    }
  }
}

// libghmm takes the lists A, B and pi as they stand in the file.
TEST(RecordedAnswersTest, LibghmmGivesOurLikelihoods) {
  const Model model = HmmSample();
  const json file = json::parse(HmmsToJson(model, HmmJsonStyle::kGhmm));
  const auto sequences = HmmSequences(model);
  for (size_t k = 0; k < 3; ++k) {
    const json& lists = file["classes"][k]["hmms"][0];
    GaussianHmm hmm;
    hmm.start = lists["pi"].get<std::vector<double>>();
    hmm.states = static_cast<int>(hmm.start.size());
    for (const json& row : lists["A"]) {
      for (const json& entry : row) hmm.transition.push_back(entry);
    }
    for (const json& state : lists["B"]) {
      for (const json& entry : state[0]) hmm.means.push_back(entry);
      for (const json& entry : state[1]) hmm.covariances.push_back(entry);
      hmm.dimensions = static_cast<int>(state[0].size());
    }
    const auto peer = client::MakeGhmmPeer(hmm);
    std::vector<double> flat;
    for (const auto& row : sequences[k].observations) {
      flat.insert(flat.end(), row.begin(), row.end());
    }
    const auto theirs = peer->LogLikelihood(flat);
    ASSERT_TRUE(theirs.ok()) << theirs.status();
    EXPECT_NEAR(sequences[k].log_likelihood[k], *theirs,
                kLikelihood * std::abs(*theirs));
  }
}

}  // namespace
}  // namespace tactus::internal
