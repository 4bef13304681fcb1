// File: network.h
//
// LstmNetwork: a classifier of sequences, with stacked LSTM layers and a dense
// softmax (paper, Section "Long Short-Term Memory Networks"). With two
// features, two layers of 50 cells and four classes it has the paper's 31,004
// parameters. It may also regress R quantities: for each, the dense layer then
// outputs mean and log-variance of a Gaussian. Networks of other programs may
// have hidden dense layers before the output layer; training makes none.
//
//   LstmNetwork network = RandomNetwork(2, {50, 50}, 4, Activation::kSoftsign,
//                                       GateActivation::kHardSigmoid, seed);
//   TACTUS_ASSIGN_OR_RETURN(CompiledLstm lstm, CompiledLstm::Create(network));
//
// One layer, with input x[t], output h[t] and cell c[t] (both 0 before the
// first step):
//   i = gate(Wi x[t] + Ui h[t-1] + bi)      f, o likewise
//   c[t] = f c[t-1] + i act(Wc x[t] + Uc h[t-1] + bc)
//   h[t] = o act(c[t])
//
// Plain data, copyable; safe to share between threads once built.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/status.h"

namespace tactus::internal {

// tanh(x), or x / (1 + |x|).
enum class Activation { kTanh, kSoftsign };

// 1 / (1 + exp(-x)), or clamp(0.2 x + 0.5, 0, 1).
enum class GateActivation { kSigmoid, kHardSigmoid };

// A layer of I inputs and H cells. Row blocks of H: gates i, f, c, o.
struct LstmLayer {
  int inputs = 0;
  int cells = 0;
  // 4H x I, row-major.
  std::vector<float> kernel;
  // 4H x H, row-major.
  std::vector<float> recurrent;
  // 4H.
  std::vector<float> bias;
};

// x, max(x, 0), tanh(x), or 1 / (1 + exp(-x)).
enum class HiddenActivation { kLinear, kRelu, kTanh, kSigmoid };

// A hidden dense layer of I inputs and U units.
struct HiddenLayer {
  int inputs = 0;
  int units = 0;
  HiddenActivation activation = HiddenActivation::kLinear;
  // U x I, row-major.
  std::vector<float> kernel;
  // U.
  std::vector<float> bias;
};

struct LstmNetwork {
  Activation activation = Activation::kTanh;
  GateActivation gate_activation = GateActivation::kSigmoid;
  // First layer first.
  std::vector<LstmLayer> layers;
  // Between the last LSTM layer and the output layer, first layer first.
  std::vector<HiddenLayer> hidden = {};
  // R.
  int regressions = 0;
  // (classes + 2R) x features(), row-major: the rows of the classes, of the R
  // means, of the R log-variances.
  std::vector<float> dense_kernel;
  // One per row of `dense_kernel`.
  std::vector<float> dense_bias;

  int inputs() const { return layers.empty() ? 0 : layers.front().inputs; }
  int classes() const {
    return static_cast<int>(static_cast<int64_t>(dense_bias.size()) -
                            2 * int64_t{regressions});
  }
  // Inputs of the output layer: units of the last hidden layer, or cells of the
  // last LSTM layer.
  int features() const {
    if (!hidden.empty()) return hidden.back().units;
    return layers.empty() ? 0 : layers.back().cells;
  }
  int64_t parameter_count() const;
};

// OK if the sizes fit together and every weight is finite and within limits;
// else INVALID_MODEL naming the field.
absl::Status Validate(const LstmNetwork& network);

// A network to train or to test with: weights uniform in the limits of Glorot
// and Bengio (AISTATS 2010), gate by gate; biases 0, those of the forget gates
// `forget_bias`. The same seed gives the same bits.
LstmNetwork RandomNetwork(int inputs, const std::vector<int>& cells,
                          int classes, Activation activation,
                          GateActivation gate_activation, uint64_t seed,
                          float forget_bias = 1, int regressions = 0);

}  // namespace tactus::internal
