#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/base/status_macros.h"
#include "core/lstm/stepper.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/timing.h"
#include "tests/bench/torch_peer.h"

namespace tactus::internal::client {
namespace {

constexpr double kTolerance = 1e-5;
constexpr int kPaperInputs = 3;
constexpr int kTunedInputs = 57;

struct Case {
  const char* name;
  int inputs;
  int streams;
};

// Ours and PyTorch's, or ours alone where `peer` is null.
absl::StatusOr<BenchRow> Measure(const Case& c, TorchPeer* peer, bool quick) {
  // Few enough that a repetition is seldom interrupted.
  const int steps = c.streams == 1 ? 20 : 4;
  const LstmNetwork network =
      RandomNetwork(c.inputs, {50, 50}, 4, Activation::kTanh,
                    GateActivation::kSigmoid, /*seed=*/1);
  TACTUS_ASSIGN_OR_RETURN(const CompiledLstm lstm,
                          CompiledLstm::Create(network));
  Random random(2);
  TorchCase work = {.network = &network, .steps = steps, .batch = c.streams};
  std::vector<std::vector<double>> frames(steps);
  for (auto& frame : frames) {
    for (int i = 0; i < c.streams * c.inputs; ++i) {
      work.inputs.push_back(static_cast<float>(random.Gaussian()));
      frame.push_back(work.inputs.back());
    }
  }
  LstmStepper stepper(lstm, c.streams);
  BenchRow row = {.name = c.name, .unit = "ns", .peer_name = kTorch};
  const int repetitions = quick ? 3 : 201;
  const auto ours = [&] {
    for (const auto& frame : frames) stepper.Step(frame);
  };
  if (peer == nullptr) {
    row.ours = MedianSeconds(repetitions, ours) / steps * 1e9;
    return row;
  }
  TACTUS_RETURN_IF_ERROR(peer->Load(work));
  TACTUS_ASSIGN_OR_RETURN(const std::vector<double> want, peer->Answer());
  row.error = 0;
  row.error_reference = "PyTorch's probabilities";
  size_t at = 0;
  for (const auto& frame : frames) {
    stepper.Step(frame);
    for (int stream = 0; stream < c.streams; ++stream) {
      for (const double probability : stepper.probability(stream)) {
        row.error = std::max(*row.error, std::abs(probability - want.at(at++)));
      }
    }
  }
  if (!(*row.error <= kTolerance)) {
    return NumericalFailure(
        absl::StrCat(c.name, " is ", *row.error, " off ", row.error_reference));
  }
  const Timing timing =
      Interleave(repetitions, ours, [&] { return peer->Repeat(); });
  row.ours = timing.ours / steps * 1e9;
  row.peer = timing.peer / steps * 1e9;
  return row;
}

class LstmBenchmark : public Benchmark {
 public:
  const char* name() const override { return "lstm"; }
  const char* description() const override {
    return "LSTM networks, one frame at a time";
  }

  absl::StatusOr<std::vector<BenchRow>> Run(bool quick) override {
    TACTUS_ASSIGN_OR_RETURN(const auto peer, TorchPeer::Start());
    std::vector<BenchRow> rows;
    for (const Case& c : {Case{"lstm/step", kPaperInputs, 1},
                          Case{"lstm/step_tuned", kTunedInputs, 1},
                          Case{"lstm/batch64", kPaperInputs, 64}}) {
      TACTUS_ASSIGN_OR_RETURN(BenchRow row, Measure(c, peer.get(), quick));
      rows.push_back(std::move(row));
    }
    return rows;
  }
};

}  // namespace

std::unique_ptr<Benchmark> MakeLstmBenchmark() {
  return std::make_unique<LstmBenchmark>();
}

}  // namespace tactus::internal::client
