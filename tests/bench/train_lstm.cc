#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/base/status_macros.h"
#include "core/lstm/backprop.h"
#include "core/lstm/optimizer.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/timing.h"
#include "tests/bench/torch_peer.h"

namespace tactus::internal::client {
namespace {

constexpr double kTolerance = 1e-4;
constexpr int kInputs = 3;
constexpr int kClasses = 4;
constexpr int kBatch = 5;
constexpr int kSteps = 500;

// In the order of TorchPeer::Answer().
std::vector<float> Flatten(const LstmNetwork& network) {
  std::vector<float> all;
  const auto append = [&all](const std::vector<float>& part) {
    all.insert(all.end(), part.begin(), part.end());
  };
  for (const LstmLayer& layer : network.layers) {
    append(layer.kernel);
    append(layer.recurrent);
    append(layer.bias);
  }
  append(network.dense_kernel);
  append(network.dense_bias);
  return all;
}

absl::StatusOr<double> LargestError(const std::vector<float>& got,
                                    const std::vector<double>& want) {
  if (got.size() != want.size()) {
    return NumericalFailure("the gradients are of different sizes");
  }
  double largest = 0;
  double error = 0;
  for (size_t i = 0; i < got.size(); ++i) {
    largest = std::max(largest, std::abs(want[i]));
    error = std::max(error, std::abs(got[i] - want[i]));
  }
  error /= largest;
  if (error <= kTolerance) return error;
  return NumericalFailure(absl::StrCat("the gradient is ", error, " off"));
}

// One batch, ours and as PyTorch takes it.
struct Batch {
  std::vector<std::vector<float>> inputs;
  std::vector<LstmSequence> sequences;
  TorchCase work;
};

Batch MakeBatch(const LstmNetwork& network) {
  Batch batch;
  batch.work = {
      .network = &network, .steps = kSteps, .batch = kBatch, .train = true};
  batch.work.inputs.resize(size_t{kSteps} * kBatch * kInputs);
  Random random(2);
  for (int i = 0; i < kBatch; ++i) {
    std::vector<float>& inputs = batch.inputs.emplace_back();
    for (int t = 0; t < kSteps; ++t) {
      for (int k = 0; k < kInputs; ++k) {
        inputs.push_back(static_cast<float>(random.Gaussian()));
        batch.work.inputs[(size_t(t) * kBatch + i) * kInputs + k] =
            inputs.back();
      }
    }
    batch.work.labels.push_back(i % kClasses);
  }
  for (int i = 0; i < kBatch; ++i) {
    batch.sequences.push_back(
        {.inputs = batch.inputs[i], .label = batch.work.labels[i]});
  }
  return batch;
}

class TrainLstmBenchmark : public Benchmark {
 public:
  const char* name() const override { return "train-lstm"; }
  const char* description() const override {
    return "One step of LSTM training";
  }

  absl::StatusOr<std::vector<BenchRow>> Run(bool quick) override {
    LstmNetwork network =
        RandomNetwork(kInputs, {50, 50}, kClasses, Activation::kTanh,
                      GateActivation::kSigmoid, /*seed=*/1);
    const Batch batch = MakeBatch(network);
    LstmBackprop backprop(network);
    LstmNetwork gradient = network;
    OptimizerState state;
    const auto find_gradient = [&] {
      Random unused(0);
      backprop.SetWeights(network);
      backprop.Forward(batch.sequences, {}, unused);
      backprop.Loss({});
      backprop.Backward(gradient);
    };
    const auto train = [&] {
      find_gradient();
      const OptimizerOptions options;
      OptimizerStep(options, options.learning_rate, gradient, state, network);
    };
    BenchRow row = {
        .name = "train-lstm/step", .unit = "ms", .peer_name = kTorch};
    const int repetitions = quick ? 2 : 21;
    TACTUS_ASSIGN_OR_RETURN(const auto peer, TorchPeer::Start());
    if (peer == nullptr) {
      row.ours = MedianSeconds(repetitions, train) * 1e3;
      return std::vector{row};
    }
    TACTUS_RETURN_IF_ERROR(peer->Load(batch.work));
    TACTUS_ASSIGN_OR_RETURN(const auto want, peer->Answer());
    find_gradient();
    TACTUS_ASSIGN_OR_RETURN(row.error, LargestError(Flatten(gradient), want));
    row.error_reference = "PyTorch's gradient";
    const Timing timing =
        Interleave(repetitions, train, [&] { return peer->Repeat(); });
    row.ours = timing.ours * 1e3;
    row.peer = timing.peer * 1e3;
    return std::vector{row};
  }
};

}  // namespace

std::unique_ptr<Benchmark> MakeTrainLstmBenchmark() {
  return std::make_unique<TrainLstmBenchmark>();
}

}  // namespace tactus::internal::client
