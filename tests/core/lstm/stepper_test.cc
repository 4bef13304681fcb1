#include "core/lstm/stepper.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "gtest/gtest.h"
#include "tests/core/lstm/lstm_cases.h"
#include "tests/core/lstm/many_steps.h"
#include "tests/reference/lstm/plain_lstm.h"
#include "tests/support/allocation_counter.h"

namespace tactus::internal {
namespace {

void ExpectDistribution(const LstmStepper& stepper) {
  double sum = 0;
  for (size_t k = 0; k < stepper.probability().size(); ++k) {
    const double probability = stepper.probability()[k];
    EXPECT_GE(probability, 0);
    sum += probability;
  }
  EXPECT_NEAR(sum, 1, 1e-12);
}

TEST(LstmStepperTest, AgreesWithPlainLoopsInDoublePrecision) {
  struct Shape {
    int inputs;
    std::vector<int> cells;
    int classes;
  };
  // Odd sizes leave no room for a wrong stride or a skipped remainder.
  const Shape shapes[] = {{2, {50, 50}, 4},
                          {3, {50, 50}, 4},
                          {1, {1}, 2},
                          {5, {7, 3, 11}, 2},
                          {2, {64}, 9}};
  uint64_t cases = 0;
  double largest = 0;
  for (const Shape& shape : shapes) {
    for (Activation activation : kActivations) {
      for (GateActivation gate : kGateActivations) {
        const uint64_t seed = ++cases;
        const LstmNetwork network = MakeNetwork(
            shape.inputs, shape.cells, shape.classes, activation, gate, seed);
        const auto inputs = MakeInputs(shape.inputs, 500, seed);
        auto lstm = CompiledLstm::Create(network);
        ASSERT_TRUE(lstm.ok()) << lstm.status();
        LstmStepper stepper(*lstm);
        const double difference = LargestDifference(PlainLstm(network, inputs),
                                                    RunAll(stepper, inputs));
        EXPECT_LE(difference, 1e-5);
        largest = std::max(largest, difference);
      }
    }
  }
  std::printf("within %.1e of plain loops\n", largest);
}

TEST(LstmStepperTest, HiddenLayersAgreeWithPlainLoops) {
  LstmNetwork network =
      MakeNetwork(3, {7, 5}, 4, Activation::kTanh, GateActivation::kSigmoid, 5);
  const auto inputs = MakeInputs(3, 200, 5);
  std::vector<std::vector<double>> before = PlainLstm(network, inputs);
  uint64_t seed = 1;
  for (const HiddenActivation activation :
       {HiddenActivation::kRelu, HiddenActivation::kTanh,
        HiddenActivation::kSigmoid, HiddenActivation::kLinear}) {
    AddHidden(3 + static_cast<int>(seed), activation, seed, network);
    ++seed;
    auto lstm = CompiledLstm::Create(network);
    ASSERT_TRUE(lstm.ok()) << lstm.status();
    LstmStepper stepper(*lstm, 2);
    LstmStepper alone(*lstm);
    const auto want = PlainLstm(network, inputs);
    EXPECT_GT(LargestDifference(want, before), 0.01);
    before = want;
    for (size_t t = 0; t < inputs.size(); ++t) {
      std::vector<double> both = inputs[t];
      both.insert(both.end(), inputs[t].begin(), inputs[t].end());
      stepper.Step(both);
      alone.Step(inputs[t]);
      for (size_t k = 0; k < 4; ++k) {
        ASSERT_EQ(stepper.probability(1)[k], alone.probability()[k]);
        ASSERT_NEAR(alone.probability()[k], want[t][k], 1e-5);
      }
    }
  }
}

TEST(LstmStepperTest, RegressionsAgreeWithPlainLoops) {
  const LstmNetwork network =
      RandomNetwork(2, {9, 7}, 3, Activation::kTanh, GateActivation::kSigmoid,
                    5, /*forget_bias=*/1, /*regressions=*/2);
  const auto inputs = MakeInputs(2, 60, 6);
  auto lstm = CompiledLstm::Create(network);
  ASSERT_TRUE(lstm.ok()) << lstm.status();
  LstmStepper stepper(*lstm);
  ASSERT_EQ(stepper.probability().size(), 3u);
  EXPECT_EQ(stepper.regression_mean()[1], 0);
  const auto probability = PlainLstm(network, inputs);
  const auto outputs = PlainOutputs(network, inputs);
  for (size_t t = 0; t < inputs.size(); ++t) {
    stepper.Step(inputs[t]);
    ASSERT_EQ(stepper.regression_mean().size(), 2u);
    ASSERT_EQ(stepper.regression_log_variance().size(), 2u);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(stepper.probability()[k], probability[t][k], 1e-5);
    }
    for (int r = 0; r < 2; ++r) {
      EXPECT_NEAR(stepper.regression_mean()[r], outputs[t][3 + r], 1e-5);
      EXPECT_NEAR(stepper.regression_log_variance()[r], outputs[t][5 + r],
                  1e-5);
    }
  }
}

TEST(LstmStepperTest, ProbabilityIsUniformBeforeTheFirstStep) {
  auto lstm = CompiledLstm::Create(
      MakeNetwork(2, {5}, 4, Activation::kTanh, GateActivation::kSigmoid, 1));
  ASSERT_TRUE(lstm.ok());
  LstmStepper stepper(*lstm);
  ExpectDistribution(stepper);
  for (double probability : stepper.probability()) {
    EXPECT_EQ(probability, 0.25);
  }
}

TEST(LstmStepperTest, ResetGivesTheSameBits) {
  for (Activation activation : kActivations) {
    for (GateActivation gate : kGateActivations) {
      auto lstm = CompiledLstm::Create(
          MakeNetwork(2, {50, 50}, 4, activation, gate, 3));
      ASSERT_TRUE(lstm.ok());
      const auto inputs = MakeInputs(2, 200, 4);
      LstmStepper stepper(*lstm);
      const auto first = RunAll(stepper, inputs);
      stepper.Reset();
      ExpectDistribution(stepper);
      EXPECT_EQ(RunAll(stepper, inputs), first);
      // A stepper elsewhere in memory, and of a copy of the network.
      const CompiledLstm copy = *lstm;
      LstmStepper other(copy);
      EXPECT_EQ(RunAll(other, inputs), first);
    }
  }
}

TEST(LstmStepperTest, SteppersOfOneNetworkDoNotDisturbEachOther) {
  auto lstm = CompiledLstm::Create(MakeNetwork(
      2, {20, 20}, 4, Activation::kTanh, GateActivation::kSigmoid, 3));
  ASSERT_TRUE(lstm.ok());
  const auto inputs = MakeInputs(2, 50, 1);
  LstmStepper alone(*lstm);
  const auto want = RunAll(alone, inputs);
  LstmStepper a(*lstm), b(*lstm);
  for (size_t t = 0; t < inputs.size(); ++t) {
    a.Step(inputs[t]);
    b.Step(inputs[inputs.size() - 1 - t]);
    EXPECT_TRUE(
        std::equal(want[t].begin(), want[t].end(), a.probability().begin()));
  }
}

TEST(LstmStepperTest, StreamsInStepGiveTheBitsOfEachAlone) {
  constexpr int kInputs = 3;
  constexpr int kSteps = 40;
  for (const LstmKernels& kernels : SupportedLstmKernels()) {
    SCOPED_TRACE(kernels.name);
    for (const int streams : {1, 2, 5, 6, 7, 13, 64}) {
      auto lstm = CompiledLstm::Create(MakeNetwork(
          kInputs, {50, 7}, 4, Activation::kTanh, GateActivation::kSigmoid, 8));
      ASSERT_TRUE(lstm.ok());
      LstmStepper together(*lstm, streams, kernels);
      std::vector<LstmStepper> alone(streams, LstmStepper(*lstm));
      std::vector<std::vector<std::vector<double>>> inputs;
      for (int stream = 0; stream < streams; ++stream) {
        inputs.push_back(MakeInputs(kInputs, kSteps, stream));
      }
      for (int t = 0; t < kSteps; ++t) {
        // One of them begins anew.
        if (t == 20) {
          together.Reset(streams / 2);
          alone[streams / 2].Reset();
        }
        std::vector<double> all;
        for (int stream = 0; stream < streams; ++stream) {
          const std::vector<double>& input = inputs[stream][t];
          all.insert(all.end(), input.begin(), input.end());
          alone[stream].Step(input);
        }
        together.Step(all);
        for (int stream = 0; stream < streams; ++stream) {
          const auto want = alone[stream].probability();
          ASSERT_TRUE(std::equal(want.begin(), want.end(),
                                 together.probability(stream).begin()))
              << stream << " of " << streams << " at " << t;
        }
      }
    }
  }
}

TEST(LstmStepperTest, ExtremeInputsAndWeightsStayFinite) {
  constexpr double kMax = std::numeric_limits<double>::max();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double values[] = {1e30,   -1e30,     kMax,       -kMax,
                           1e-310, kInfinity, -kInfinity, 0};
  for (Activation activation : kActivations) {
    for (GateActivation gate : kGateActivations) {
      for (float gain : {1.0F, 1e5F}) {
        auto lstm = CompiledLstm::Create(
            MakeNetwork(2, {50, 50}, 4, activation, gate, 6, gain));
        ASSERT_TRUE(lstm.ok()) << lstm.status();
        LstmStepper stepper(*lstm);
        for (double a : values) {
          for (double b : values) {
            stepper.Step(std::vector<double>{a, b});
            ExpectDistribution(stepper);
          }
        }
      }
    }
  }
}

TEST(LstmStepperTest, AHundredThousandStepsDoNotDrift) {
  testing::ExpectNoDrift(100'000);
}

TEST(LstmStepperTest, StepAllocatesNothing) {
  LstmNetwork network = MakeNetwork(2, {50, 50}, 4, Activation::kSoftsign,
                                    GateActivation::kHardSigmoid, 3);
  AddHidden(33, HiddenActivation::kRelu, 4, network);
  AddHidden(7, HiddenActivation::kTanh, 5, network);
  auto lstm = CompiledLstm::Create(network);
  ASSERT_TRUE(lstm.ok());
  const auto inputs = MakeInputs(2, 100, 1);
  LstmStepper stepper(*lstm);
  const testing::AllocationCounter allocations;
  for (const auto& input : inputs) stepper.Step(input);
  stepper.Reset();
  EXPECT_EQ(allocations.count(), 0);
}

}  // namespace
}  // namespace tactus::internal
