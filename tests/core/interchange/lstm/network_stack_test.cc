// Layers of other programs, put together: each place of a normalization,
// against the same formula in plain loops.
#include "core/interchange/lstm/network_stack.h"

#include <cmath>
#include <functional>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/interchange/samples.h"
#include "tests/reference/lstm/plain_lstm.h"

namespace tactus::internal {
namespace {

using ::testing::HasSubstr;

constexpr int kInputs = 3;
constexpr int kCells = 5;
constexpr int kClasses = 4;

const std::vector<double> kScale = {0.5, -2, 1.5, 0.1, 3};
const std::vector<double> kShift = {1, 0, -0.5, 2, 0.25};

LstmNetwork OneLayer() {
  return MakeNetwork(kInputs, {kCells}, kClasses, Activation::kTanh,
                     GateActivation::kSigmoid, 7);
}

NetworkStack StackOf(const LstmNetwork& network) {
  NetworkStack stack;
  EXPECT_EQ(stack.AddLstm(network.layers[0], network.activation,
                          network.gate_activation),
            "");
  return stack;
}

// h[t] of the LSTM layer.
Rows CellsOf(LstmNetwork network, const Rows& inputs) {
  network.dense_kernel.assign(kCells * kCells, 0);
  for (int i = 0; i < kCells; ++i) network.dense_kernel[i * (kCells + 1)] = 1;
  network.dense_bias.assign(kCells, 0);
  return PlainOutputs(network, inputs);
}

// Posteriors of the output layer of `network`, of features that `change` makes
// of the cells.
Rows WithChange(const LstmNetwork& network, const Rows& inputs,
                const std::function<void(std::vector<double>&)>& change,
                const std::function<void(std::vector<double>&)>& after = {}) {
  Rows rows;
  for (std::vector<double> h : CellsOf(network, inputs)) {
    change(h);
    std::vector<double>& z = rows.emplace_back();
    for (int k = 0; k < kClasses; ++k) {
      double sum = network.dense_bias[k];
      for (int j = 0; j < kCells; ++j) {
        sum += network.dense_kernel[k * kCells + j] * h[j];
      }
      z.push_back(sum);
    }
    if (after) after(z);
    double total = 0;
    for (double& value : z) total += value = std::exp(value);
    for (double& value : z) value /= total;
  }
  return rows;
}

void Normalize(std::vector<double>& h) {
  for (size_t i = 0; i < h.size(); ++i) h[i] = kScale[i] * h[i] + kShift[i];
}

void ReluOf(std::vector<double>& h) {
  for (double& value : h) value = std::max(value, 0.0);
}

Rows Got(const NetworkStack& stack, const Rows& inputs, bool softmax = true) {
  std::string fault;
  const auto network = stack.Finish(softmax, &fault);
  EXPECT_TRUE(network.has_value()) << fault;
  if (!network) return {};
  EXPECT_TRUE(Validate(*network).ok()) << Validate(*network);
  return Posteriors({*network}, inputs);
}

TEST(NetworkStackTest, ANormalizationBehindTheCellsMovesIntoWhatFollows) {
  const LstmNetwork network = OneLayer();
  const Rows inputs = MakeInputs(kInputs, 30, 3);
  NetworkStack dense = StackOf(network);
  ASSERT_EQ(dense.Scale(kScale, kShift), "");
  NetworkStack activated = dense;
  ASSERT_EQ(dense.AddDense(kClasses, network.dense_kernel, network.dense_bias),
            "");
  EXPECT_LE(LargestDifference(Got(dense, inputs),
                              WithChange(network, inputs, Normalize)),
            1e-5);
  ASSERT_EQ(activated.Activate(HiddenActivation::kRelu), "");
  ASSERT_EQ(
      activated.AddDense(kClasses, network.dense_kernel, network.dense_bias),
      "");
  const auto both = [](std::vector<double>& h) {
    Normalize(h);
    ReluOf(h);
  };
  EXPECT_LE(LargestDifference(Got(activated, inputs),
                              WithChange(network, inputs, both)),
            1e-5);
}

TEST(NetworkStackTest, TwoNormalizationsAroundAnActivation) {
  const LstmNetwork network = OneLayer();
  const Rows inputs = MakeInputs(kInputs, 30, 4);
  NetworkStack stack = StackOf(network);
  ASSERT_EQ(stack.Activate(HiddenActivation::kTanh), "");
  ASSERT_EQ(stack.Scale(kScale, kShift), "");
  ASSERT_EQ(stack.Scale(kScale, kShift), "");
  ASSERT_EQ(stack.AddDense(kClasses, network.dense_kernel, network.dense_bias),
            "");
  const auto change = [](std::vector<double>& h) {
    for (double& value : h) value = std::tanh(value);
    Normalize(h);
    Normalize(h);
  };
  EXPECT_LE(LargestDifference(Got(stack, inputs),
                              WithChange(network, inputs, change)),
            1e-5);
}

TEST(NetworkStackTest, ANormalizationBehindALinearLayerMovesIntoIt) {
  const LstmNetwork network = OneLayer();
  const Rows inputs = MakeInputs(kInputs, 30, 5);
  NetworkStack stack = StackOf(network);
  ASSERT_EQ(stack.AddDense(kClasses, network.dense_kernel, network.dense_bias),
            "");
  ASSERT_EQ(stack.Scale({0.5, -2, 1.5, 0.1}, {1, 0, -0.5, 2}), "");
  const auto after = [](std::vector<double>& z) { Normalize(z); };
  EXPECT_LE(LargestDifference(Got(stack, inputs),
                              WithChange(
                                  network, inputs, [](auto&) {}, after)),
            1e-5);
  // Logits without softmax are the same.
  EXPECT_EQ(Got(stack, inputs, false), Got(stack, inputs, true));
}

TEST(NetworkStackTest, AnActivationBeforeTheSoftmaxIsKept) {
  const LstmNetwork network = OneLayer();
  const Rows inputs = MakeInputs(kInputs, 30, 6);
  NetworkStack stack = StackOf(network);
  ASSERT_EQ(stack.AddDense(kClasses, network.dense_kernel, network.dense_bias),
            "");
  ASSERT_EQ(stack.Activate(HiddenActivation::kRelu), "");
  EXPECT_LE(LargestDifference(Got(stack, inputs),
                              WithChange(
                                  network, inputs, [](auto&) {}, ReluOf)),
            1e-5);
  std::string fault;
  EXPECT_FALSE(stack.Finish(/*softmax=*/false, &fault).has_value());
  EXPECT_THAT(fault, HasSubstr("ends with an activation"));
}

TEST(NetworkStackTest, InputsMayBeNormalized) {
  const LstmNetwork network = OneLayer();
  Rows inputs = MakeInputs(kInputs, 30, 7);
  NetworkStack stack;
  ASSERT_EQ(stack.Scale({2, 0.5, -1}, {0.1, 0.2, 0.3}), "");
  ASSERT_EQ(stack.AddLstm(network.layers[0], network.activation,
                          network.gate_activation),
            "");
  ASSERT_EQ(stack.AddDense(kClasses, network.dense_kernel, network.dense_bias),
            "");
  const Rows got = Got(stack, inputs);
  for (std::vector<double>& row : inputs) {
    row = {2 * row[0] + 0.1, 0.5 * row[1] + 0.2, -row[2] + 0.3};
  }
  EXPECT_LE(LargestDifference(got, PlainLstm(network, inputs)), 1e-5);
}

TEST(NetworkStackTest, WithoutAnythingSpecialTheWeightsAreThoseGiven) {
  const LstmNetwork network = OneLayer();
  NetworkStack stack = StackOf(network);
  ASSERT_EQ(stack.AddDense(kClasses, network.dense_kernel,
                           std::vector<float>(kClasses)),
            "");
  // As ONNX has the bias.
  ASSERT_EQ(stack.Scale(std::vector<double>(kClasses, 1),
                        {network.dense_bias.begin(), network.dense_bias.end()}),
            "");
  std::string fault;
  const auto got = stack.Finish(true, &fault);
  ASSERT_TRUE(got.has_value());
  EXPECT_TRUE(got->hidden.empty());
  EXPECT_EQ(got->dense_kernel, network.dense_kernel);
  EXPECT_EQ(got->dense_bias, network.dense_bias);
  EXPECT_EQ(got->layers[0].kernel, network.layers[0].kernel);
}

TEST(NetworkStackTest, EachFaultIsNamed) {
  const LstmNetwork network = OneLayer();
  NetworkStack stack;
  std::string fault;
  EXPECT_FALSE(stack.Finish(true, &fault).has_value());
  EXPECT_THAT(fault, HasSubstr("no LSTM layer"));
  EXPECT_THAT(stack.AddDense(1, {1}, {1}), HasSubstr("before the LSTM layers"));
  EXPECT_THAT(stack.Activate(HiddenActivation::kRelu),
              HasSubstr("before the LSTM layers"));
  stack = StackOf(network);
  EXPECT_FALSE(stack.Finish(false, &fault).has_value());
  EXPECT_THAT(fault, HasSubstr("no Dense layer"));
  EXPECT_THAT(stack.AddLstm(network.layers[0], Activation::kSoftsign,
                            network.gate_activation),
              HasSubstr("other activations"));
  EXPECT_THAT(stack.Scale({1}, {1}), HasSubstr("1 numbers for 5 features"));
  EXPECT_THAT(stack.AddDense(2, {1}, {1, 1}), HasSubstr("than the 5 of"));
  ASSERT_EQ(stack.AddDense(kClasses, network.dense_kernel, network.dense_bias),
            "");
  EXPECT_THAT(stack.AddLstm(network.layers[0], network.activation,
                            network.gate_activation),
              HasSubstr("behind a Dense layer"));
  for (int i = 0; i < 8; ++i) {
    ASSERT_EQ(stack.AddDense(4, std::vector<float>(16), {0, 0, 0, 0}), "");
  }
  EXPECT_THAT(stack.AddDense(4, std::vector<float>(16), {0, 0, 0, 0}),
              HasSubstr("at most 9"));
}

}  // namespace
}  // namespace tactus::internal
