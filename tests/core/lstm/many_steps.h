// File: many_steps.h
//
// A sequence of very many steps: a float network that forgets must agree, at
// the end, with one in double that saw only the last steps.
//
//   ExpectNoDrift(10'000'000);
//
// Free functions; thread-safe.
#pragma once

#include <cmath>
#include <vector>

#include "core/base/random.h"
#include "gtest/gtest.h"
#include "tests/core/lstm/lstm_cases.h"
#include "tests/reference/lstm/plain_lstm.h"

namespace tactus::internal::testing {

inline void ExpectNoDrift(int steps) {
  // The forget gates are about 0.7: of older steps less than 1e-100 is left.
  constexpr int kLast = 1000;
  constexpr int kCompared = 100;
  for (const Activation activation : kActivations) {
    const LstmNetwork network =
        RandomNetwork(2, {12, 12}, 4, activation, GateActivation::kSigmoid, 3);
    const auto lstm = CompiledLstm::Create(network);
    ASSERT_TRUE(lstm.ok()) << lstm.status();
    LstmStepper stepper(*lstm);
    const auto inputs = MakeInputs(2, kLast, 5);
    const auto want = PlainLstm(network, inputs);
    Random random(6);
    std::vector<double> x(2);
    for (int t = 0; t < steps - kLast; ++t) {
      // Constant for long, with bursts of any size.
      if (t % 5000 < 50) x = {random.Uniform(-9, 9), 1e6 * random.Gaussian()};
      stepper.Step(x);
      for (const double p : stepper.probability()) ASSERT_TRUE(p >= 0) << t;
    }
    for (int t = 0; t < kLast; ++t) {
      stepper.Step(inputs[t]);
      if (t < kLast - kCompared) continue;
      for (int k = 0; k < 4; ++k) {
        ASSERT_NEAR(stepper.probability()[k], want[t][k], 1e-5) << t;
      }
    }
  }
}

}  // namespace tactus::internal::testing
