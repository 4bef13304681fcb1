#include "core/lstm/noise.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/random.h"
#include "gtest/gtest.h"
#include "tests/core/lstm/training_cases.h"
#include "tests/reference/lstm/gradient.h"
#include "tests/reference/lstm/plain_lstm.h"

namespace tactus::internal {
namespace {

TEST(DropoutTest, DropsTheGivenFractionAndKeepsTheMean) {
  constexpr int kCount = 1'000'003;  // no multiple of anything
  for (const double probability : {0.001, 0.2, 0.5, 0.9}) {
    Random random(3);
    std::vector<float> mask(kCount);
    NoiseBits bits(random);
    DropoutMask(probability, bits, mask);
    double sum = 0;
    double pairs = 0;
    int dropped = 0;
    for (int i = 0; i < kCount; ++i) {
      sum += mask[i];
      dropped += mask[i] == 0;
      if (i > 0) pairs += mask[i] == 0 && mask[i - 1] == 0;
    }
    const double deviation =
        std::sqrt(probability * (1 - probability) / kCount);
    EXPECT_NEAR(dropped / double{kCount}, probability, 5 * deviation + 1e-5);
    EXPECT_NEAR(sum / kCount, 1, (5 * deviation + 1e-5) / (1 - probability));
    // Neighbours, which share a draw, are dropped independently.
    EXPECT_NEAR(pairs / kCount, probability * probability,
                5 * deviation + 1e-5);
  }
}

TEST(AddNoiseTest, AddsNormalDeviatesThatAreIndependent) {
  constexpr int kCount = 1'000'003;  // no multiple of anything
  Random random(7);
  std::vector<float> values(kCount, 2.0F);
  NoiseBits bits(random);
  AddNoise(0.5, bits, values);
  double sum = 0, squares = 0, neighbours = 0;
  std::vector<double> deviates;
  for (const float value : values) {
    const double x = (value - 2.0) / 0.5;
    sum += x;
    squares += x * x;
    if (!deviates.empty()) neighbours += x * deviates.back();
    deviates.push_back(x);
  }
  const double error = 5 / std::sqrt(double{kCount});
  EXPECT_NEAR(sum / kCount, 0, error);
  EXPECT_NEAR(squares / kCount, 1, error * std::sqrt(2.0));
  EXPECT_NEAR(neighbours / kCount, 0, error);
  // The distribution function, against the closed form.
  std::sort(deviates.begin(), deviates.end());
  for (const double x : {-3.0, -2.0, -1.0, -0.3, 0.0, 0.3, 1.0, 2.0, 3.0}) {
    const auto below = std::lower_bound(deviates.begin(), deviates.end(), x);
    EXPECT_NEAR((below - deviates.begin()) / double{kCount},
                0.5 * std::erfc(-x / std::sqrt(2.0)), error / 2 + 1.0 / 4096)
        << x;
  }
}

LstmNetwork Network(const std::vector<int>& cells) {
  return RandomNetwork(2, cells, 3, Activation::kTanh, GateActivation::kSigmoid,
                       4);
}

double LossOf(const LstmNetwork& network, const TrainingSet& set,
              double dropout, uint64_t seed) {
  return LossAndGradient(network, set.views, {}, {.dropout = dropout}, seed)
      ->loss;
}

TEST(DropoutTest, LiesBetweenLayersOnly) {
  const LstmNetwork one = Network({9});
  const TrainingSet set = RandomTrainingSet(one, {12, 7}, 5);
  EXPECT_EQ(LossOf(one, set, 0.5, 1), LossOf(one, set, 0, 1));
  const LstmNetwork two = Network({9, 8});
  EXPECT_NE(LossOf(two, set, 0.5, 1), LossOf(two, set, 0, 1));
  EXPECT_NE(LossOf(two, set, 0.5, 1), LossOf(two, set, 0.5, 2));
  EXPECT_EQ(LossOf(two, set, 0.5, 1), LossOf(two, set, 0.5, 1));
}

// The gradient belongs to the disturbed loss: along the gradient, the loss with
// the same noise grows as the gradient predicts.
TEST(DropoutTest, TheGradientIsThatOfTheDisturbedLoss) {
  const LstmNetwork network = Network({9, 8, 7});
  const TrainingSet set = RandomTrainingSet(network, {12, 7, 12}, 5);
  const LstmNoise noise = {.dropout = 0.4, .input = 0.5};
  auto at = LossAndGradient(network, set.views, {}, noise, 6);
  ASSERT_TRUE(at.ok()) << at.status();
  const auto slopes = Tensors(at->gradient);
  // In each tensor separately.
  for (size_t i = 0; i < slopes.size(); ++i) {
    double squares = 0;
    for (const float slope : *slopes[i].values) squares += slope * slope;
    const double step = 0.02 / std::sqrt(squares);
    const auto moved = [&](double by) {
      LstmNetwork there = network;
      std::vector<float>& weights = *Tensors(there)[i].values;
      for (size_t k = 0; k < weights.size(); ++k) {
        weights[k] += static_cast<float>(by * (*slopes[i].values)[k]);
      }
      return LossAndGradient(there, set.views, {}, noise, 6)->loss;
    };
    EXPECT_NEAR((moved(step) - moved(-step)) / (2 * step), squares,
                0.01 * squares)
        << slopes[i].name;
  }
}

}  // namespace
}  // namespace tactus::internal
