#include "core/lstm/kernels.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "core/base/random.h"
#include "core/lstm/backprop.h"
#include "gtest/gtest.h"
#include "tests/core/lstm/training_cases.h"

namespace tactus::internal {
namespace {

LstmBuffer Numbers(size_t size, uint64_t seed, double spread = 1) {
  Random random(seed);
  LstmBuffer values(size);
  for (float& value : values) {
    value = static_cast<float>(spread * random.Gaussian());
  }
  return values;
}

// As the header defines it: one sum per number, in order.
void PlainProduct(const LstmProduct& p) {
  for (int m = 0; m < p.rows; ++m) {
    for (int n = 0; n < p.columns; ++n) {
      float sum = p.start[m * p.start_row + n];
      for (int k = 0; k < p.inner; ++k) {
        sum += p.a[m * p.a_row + k * p.a_column] * p.b[k * p.b_row + n];
      }
      p.c[m * p.c_row + n] = sum;
    }
  }
}

TEST(LstmKernelsTest, ProductsAreThoseOfAPlainLoopBitForBit) {
  const LstmBuffer a = Numbers(700 * 20, 1);
  const LstmBuffer b = Numbers(700 * 128, 2);
  const LstmBuffer start = Numbers(20 * 128, 3);
  for (const LstmKernels& kernels : SupportedLstmKernels()) {
    SCOPED_TRACE(kernels.name);
    for (const int rows : {1, 2, 3, 4, 5, 6, 7, 17}) {
      for (const int inner : {1, 3, 50, 256, 513}) {
        for (const int columns : {16, 80, 112}) {
          for (const bool transposed : {false, true}) {
            for (const int start_row : {0, 128}) {
              LstmProduct p = {.rows = rows,
                               .inner = inner,
                               .columns = columns,
                               .a = a.data(),
                               .a_row = transposed ? 1 : 700,
                               .a_column = transposed ? 20 : 1,
                               .b = b.data(),
                               .b_row = 128,
                               .start = start.data(),
                               .start_row = start_row};
              LstmBuffer got(20 * 128, -1), want(20 * 128, -1);
              p.c_row = 128;
              p.c = want.data();
              PlainProduct(p);
              p.c = got.data();
              kernels.product(p);
              ASSERT_EQ(got, want)
                  << rows << " x " << inner << " x " << columns;
              // On top of what is there.
              p.start = p.c = want.data();
              p.start_row = 128;
              PlainProduct(p);
              p.start = p.c = got.data();
              kernels.product(p);
              ASSERT_EQ(got, want);
            }
          }
        }
      }
    }
  }
}

// One step of a layer, forward and backward, by one kernel.
struct Step {
  LstmCellShape shape;
  LstmBuffer gates, cell, squashed, output, carry, deltas;
};

Step RunStep(const LstmKernels& kernels, int cells, Activation activation,
             GateActivation gate) {
  constexpr int kRows = 3;
  Step step;
  step.shape = {.rows = kRows,
                .cells = cells,
                .activation = activation,
                .gate_activation = gate,
                .gate_row = Padded(4 * cells),
                .cell_row = Padded(cells)};
  const size_t size = kRows * Padded(cells);
  const size_t gates = kRows * Padded(4 * cells) + kLstmLanes;
  const LstmBuffer previous = Numbers(size, 5);
  const LstmBuffer above = Numbers(size, 6), next = Numbers(size, 7);
  step.gates = Numbers(gates, 4, 3);
  step.cell = step.squashed = step.output = LstmBuffer(size);
  kernels.cell_forward({.shape = step.shape,
                        .gates = step.gates.data(),
                        .previous = previous.data(),
                        .cell = step.cell.data(),
                        .squashed = step.squashed.data(),
                        .output = step.output.data()});
  step.carry = Numbers(size, 8);
  step.deltas = LstmBuffer(gates);
  kernels.cell_backward({.shape = step.shape,
                         .gates = step.gates.data(),
                         .previous = previous.data(),
                         .squashed = step.squashed.data(),
                         .from_above = above.data(),
                         .from_next = next.data(),
                         .carry = step.carry.data(),
                         .deltas = step.deltas.data()});
  return step;
}

// The numbers of the cells, without the padding.
std::vector<float> OfCells(const Step& step, const LstmBuffer& values) {
  std::vector<float> result;
  for (int row = 0; row < step.shape.rows; ++row) {
    const auto from = values.begin() + row * step.shape.cell_row;
    result.insert(result.end(), from, from + step.shape.cells);
  }
  return result;
}

TEST(LstmKernelsTest, EveryWidthGivesTheSameBits) {
  const auto all = SupportedLstmKernels();
  for (const Activation activation : kActivations) {
    for (const GateActivation gate : kGateActivations) {
      for (const int cells : {1, 3, 16, 17, 50, 64}) {
        const Step want = RunStep(all.front(), cells, activation, gate);
        for (const LstmKernels& kernels : all) {
          SCOPED_TRACE(kernels.name);
          const Step got = RunStep(kernels, cells, activation, gate);
          for (const auto member :
               {&Step::cell, &Step::squashed, &Step::output, &Step::carry}) {
            ASSERT_EQ(OfCells(got, got.*member), OfCells(want, want.*member));
          }
          ASSERT_EQ(got.deltas, want.deltas);
        }
      }
    }
  }
}

TEST(LstmKernelsTest, ActivationsAreCloseOverTheirWholeRange) {
  double worst = 0;
  for (const LstmKernels& kernels : SupportedLstmKernels()) {
    for (int i = -4000; i <= 4000; ++i) {
      // Sums to +-64 in fine steps, and far beyond.
      const float x = static_cast<float>(i % 2 == 0 ? i * 0.016 : i * 1e34);
      std::vector<float> gates(kLstmLanes * 2, x);
      const LstmBuffer previous(kLstmLanes);
      LstmBuffer cell(kLstmLanes), squashed(kLstmLanes), output(kLstmLanes);
      kernels.cell_forward(
          {.shape = {.rows = 1,
                     .cells = 1,
                     .activation = Activation::kTanh,
                     .gate_activation = GateActivation::kSigmoid,
                     .gate_row = kLstmLanes,
                     .cell_row = kLstmLanes},
           .gates = gates.data(),
           .previous = previous.data(),
           .cell = cell.data(),
           .squashed = squashed.data(),
           .output = output.data()});
      worst =
          std::max(worst, std::abs(gates[0] - 1 / (1 + std::exp(-double{x}))));
      worst = std::max(worst, std::abs(gates[2] - std::tanh(double{x})));
    }
  }
  std::printf("within %.1e\n", worst);
  EXPECT_LE(worst, 2e-7);
}

TEST(LstmKernelsTest, FadingGradientsEndAtZeroNotInDenormals) {
  for (const LstmKernels& kernels : SupportedLstmKernels()) {
    for (const Activation activation : kActivations) {
      for (const GateActivation gate : kGateActivations) {
        const size_t size = kLstmLanes;
        const LstmBuffer gates(5 * size, 0.5F), zeros(size);
        const LstmBuffer previous(size, 0.5F), squashed(size, 0.5F);
        LstmBuffer carry(size, 1.0F), deltas(5 * size);
        for (int t = 0; t < 200; ++t) {
          kernels.cell_backward({.shape = {.rows = 1,
                                           .cells = 16,
                                           .activation = activation,
                                           .gate_activation = gate,
                                           .gate_row = 4 * kLstmLanes,
                                           .cell_row = kLstmLanes},
                                 .gates = gates.data(),
                                 .previous = previous.data(),
                                 .squashed = squashed.data(),
                                 .from_above = zeros.data(),
                                 .from_next = zeros.data(),
                                 .carry = carry.data(),
                                 .deltas = deltas.data()});
          for (const float value : carry) {
            ASSERT_FALSE(std::fpclassify(value) == FP_SUBNORMAL) << t;
          }
          for (const float value : deltas) {
            ASSERT_FALSE(std::fpclassify(value) == FP_SUBNORMAL) << t;
          }
        }
        EXPECT_EQ(carry[0], 0);
      }
    }
  }
}

TEST(LstmKernelsTest, AWholeGradientHasTheSameBitsAtEveryWidth) {
  const LstmNetwork network =
      RandomNetwork(3, {50, 21}, 4, Activation::kTanh, GateActivation::kSigmoid,
                    3, /*forget_bias=*/1, /*regressions=*/1);
  const TrainingSet set = RandomTrainingSet(network, {30, 12, 30, 25}, 4);
  const auto run = [&](const LstmKernels& kernels) {
    LstmBackprop backprop(network, kernels);
    LstmNetwork gradient = network;
    Random random(5);
    backprop.SetWeights(network);
    backprop.Forward(set.views, {.dropout = 0.3, .input = 0.1}, random);
    backprop.Loss({.steps = LstmLoss::kEveryStep});
    backprop.Backward(gradient);
    return gradient;
  };
  LstmNetwork want = run(SupportedLstmKernels().front());
  for (const LstmKernels& kernels : SupportedLstmKernels()) {
    LstmNetwork got = run(kernels);
    const auto x = Tensors(got), y = Tensors(want);
    for (size_t i = 0; i < x.size(); ++i) {
      ASSERT_EQ(*x[i].values, *y[i].values) << kernels.name << x[i].name;
    }
  }
}

}  // namespace
}  // namespace tactus::internal
