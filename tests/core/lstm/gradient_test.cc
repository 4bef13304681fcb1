#include "tests/reference/lstm/gradient.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "core/base/errors.h"
#include "core/lstm/batch_gradient.h"
#include "gtest/gtest.h"
#include "tests/core/lstm/training_cases.h"
#include "tests/reference/lstm/plain_lstm.h"
#include "tests/support/allocation_counter.h"

namespace tactus::internal {
namespace {

LstmNetwork Network(Activation activation, GateActivation gate,
                    int regressions = 2) {
  return RandomNetwork(3, {3, 17}, 4, activation, gate, 7, /*forget_bias=*/1,
                       regressions);
}

LstmLossOptions EveryStep() {
  return {.steps = LstmLoss::kEveryStep,
          .first_step = 2,
          .stride = 3,
          .label_smoothing = 0.1,
          .regression_weight = 0.7};
}

// Central difference of the plain loss, in double precision, by one weight.
double Slope(LstmNetwork& network, float& weight,
             std::span<const LstmSequence> batch,
             const LstmLossOptions& options) {
  const float at = weight;
  const auto loss_at = [&](float value) {
    weight = value;
    return PlainLoss(network, batch, options);
  };
  const float above = at + 1e-5F;
  const float below = at - 1e-5F;
  const double slope =
      (loss_at(above) - loss_at(below)) / (double{above} - double{below});
  weight = at;
  return slope;
}

// Largest difference of the gradient from finite differences,
// relative to the largest slope of the tensor. Every tensor has a
// slope that counts.
double GradientError(LstmNetwork network, std::span<const LstmSequence> batch,
                     const LstmLossOptions& options) {
  auto got = LossAndGradient(network, batch, options);
  EXPECT_TRUE(got.ok()) << got.status();
  if (!got.ok()) return HUGE_VAL;
  EXPECT_NEAR(got->loss, PlainLoss(network, batch, options), 1e-6);
  double worst = 0;
  const auto weights = Tensors(network);
  const auto gradients = Tensors(got->gradient);
  for (size_t i = 0; i < weights.size(); ++i) {
    double largest = 0;
    double error = 0;
    for (size_t k = 0; k < weights[i].values->size(); ++k) {
      const double slope =
          Slope(network, (*weights[i].values)[k], batch, options);
      largest = std::max(largest, std::abs(slope));
      error = std::max(error, std::abs(slope - (*gradients[i].values)[k]));
    }
    EXPECT_GT(largest, 1e-4) << weights[i].name;
    EXPECT_LE(error, 2e-5 * largest) << weights[i].name;
    worst = std::max(worst, error / largest);
  }
  return worst;
}

TEST(LstmGradientTest, AgreesWithFiniteDifferences) {
  double worst = 0;
  for (const Activation activation : kActivations) {
    for (const GateActivation gate : kGateActivations) {
      for (const bool every : {false, true}) {
        SCOPED_TRACE(Name(activation) + " " + Name(gate));
        const LstmNetwork network = Network(activation, gate);
        // Lengths out of order, two of them equal, one a single
        // step.
        const TrainingSet set = RandomTrainingSet(network, {4, 6, 1, 6}, 21);
        worst = std::max(
            worst, GradientError(network, set.views,
                                 every ? EveryStep() : LstmLossOptions{}));
      }
    }
  }
  std::printf("within %.1e of finite differences\n", worst);
}

TEST(LstmGradientTest, ASequenceAddsTheSameAloneAndAmongOthers) {
  const LstmNetwork network =
      Network(Activation::kTanh, GateActivation::kSigmoid);
  const TrainingSet set = RandomTrainingSet(network, {4, 40, 1, 40, 17}, 22);
  auto together = LossAndGradient(network, set.views, EveryStep());
  ASSERT_TRUE(together.ok()) << together.status();
  LstmNetwork sum = network;
  for (const NamedTensor& tensor : Tensors(sum)) {
    std::fill(tensor.values->begin(), tensor.values->end(), 0.0F);
  }
  double loss = 0;
  for (const LstmSequence& sequence : set.views) {
    auto alone = LossAndGradient(network, {&sequence, 1}, EveryStep());
    ASSERT_TRUE(alone.ok()) << alone.status();
    loss += alone->loss / 5;
    const auto to = Tensors(sum), from = Tensors(alone->gradient);
    for (size_t i = 0; i < to.size(); ++i) {
      for (size_t k = 0; k < to[i].values->size(); ++k) {
        (*to[i].values)[k] += (*from[i].values)[k] / 5;
      }
    }
  }
  EXPECT_NEAR(together->loss, loss, 1e-12);
  const auto got = Tensors(together->gradient), want = Tensors(sum);
  for (size_t i = 0; i < got.size(); ++i) {
    for (size_t k = 0; k < got[i].values->size(); ++k) {
      EXPECT_NEAR((*got[i].values)[k], (*want[i].values)[k], 1e-6)
          << got[i].name;
    }
  }
}

TEST(LstmGradientTest, TheSecondBatchAllocatesNothing) {
  LstmNetwork network = Network(Activation::kTanh, GateActivation::kSigmoid);
  const TrainingSet large = RandomTrainingSet(network, {20, 30, 30}, 23);
  const TrainingSet small = RandomTrainingSet(network, {9, 5}, 24);
  LstmNetwork gradient = network;
  LstmBackprop backprop(network);
  Random random(1);
  const auto run = [&](const TrainingSet& set) {
    backprop.SetWeights(network);
    backprop.Forward(set.views, {.dropout = 0.2, .input = 0.1}, random);
    backprop.Loss(EveryStep());
    backprop.Backward(gradient);
  };
  run(large);
  const testing::AllocationCounter allocations;
  run(small);
  run(large);
  EXPECT_EQ(allocations.count(), 0);
}

// Relative to the largest number of the tensor.
double Difference(LstmNetwork& a, LstmNetwork& b) {
  double worst = 0;
  const auto ours = Tensors(a);
  const auto others = Tensors(b);
  for (size_t i = 0; i < ours.size(); ++i) {
    double largest = 0;
    double error = 0;
    for (size_t k = 0; k < ours[i].values->size(); ++k) {
      const double value = (*others[i].values)[k];
      largest = std::max(largest, std::abs(value));
      error = std::max(error, std::abs((*ours[i].values)[k] - value));
    }
    worst = std::max(worst, error / largest);
  }
  return worst;
}

// Without noise, which each shard draws for itself.
TEST(LstmGradientTest, ShardsSumToTheGradientOfTheBatch) {
  const LstmNetwork network =
      Network(Activation::kTanh, GateActivation::kSigmoid);
  const TrainingSet set =
      RandomTrainingSet(network, {7, 3, 12, 5, 9, 1, 8}, 11);
  LstmSequencesInMemory source(set.views);
  const std::vector<size_t> numbers = {4, 0, 6, 2, 1, 5, 3};
  LstmTrainOptions options;
  options.noise = {.dropout = 0, .input = 0};
  OneRank alone;
  const auto compute = [&](int shards, LstmNetwork& gradient) {
    options.shards = shards;
    BatchGradient batches(network, source, options, alone);
    return batches.Compute(network, numbers, 5, gradient);
  };
  LstmNetwork whole = network;
  const auto expected = compute(1, whole);
  ASSERT_TRUE(expected.ok()) << expected.status();
  // More shards than sequences are as many as sequences.
  for (const int shards : {2, 3, 7, 20}) {
    LstmNetwork gradient = network;
    const auto loss = compute(shards, gradient);
    ASSERT_TRUE(loss.ok()) << loss.status();
    EXPECT_NEAR(loss->sum, expected->sum, 1e-5 * expected->sum);
    EXPECT_EQ(loss->correct, expected->correct);
    EXPECT_LE(Difference(gradient, whole), 1e-5) << shards;
  }
}

}  // namespace
}  // namespace tactus::internal
