// Ten million frames of one contact. A constant observation makes the forward
// algorithm a power of one matrix, which squaring gives in quadruple precision.
#include <quadmath.h>

#include <array>
#include <cmath>
#include <limits>

#include "core/hmm/hmm_bank.h"
#include "core/hmm/scaled_filter.h"
#include "gtest/gtest.h"
#include "tests/core/hmm/random_model.h"
#include "tests/reference/hmm/forward_filter.h"

namespace tactus::internal {
namespace {

using Quad = __float128;

constexpr int kFrames = 10'000'000;
constexpr double kValue = 0.4;

GaussianHmm TwoStates() {
  GaussianHmm model;
  model.states = 2;
  model.dimensions = 1;
  model.covariance_type = CovarianceType::kSpherical;
  model.start = {0.3, 0.7};
  model.transition = {0.95, 0.05, 0.2, 0.8};
  model.means = {0, 1.5};
  model.covariances = {0.7, 0.4};
  return model;
}

// A matrix 2^exponent.
struct Scaled {
  std::array<Quad, 4> matrix;
  long exponent = 0;
};

Scaled Multiply(const Scaled& a, const Scaled& b) {
  Scaled c;
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      c.matrix[2 * i + j] =
          a.matrix[2 * i] * b.matrix[j] + a.matrix[2 * i + 1] * b.matrix[2 + j];
    }
  }
  int shift = 0;
  frexpq(c.matrix[0] + c.matrix[1] + c.matrix[2] + c.matrix[3], &shift);
  for (Quad& value : c.matrix) value = ldexpq(value, -shift);
  c.exponent = a.exponent + b.exponent + shift;
  return c;
}

Quad LogLikelihood(const GaussianHmm& model) {
  std::array<Quad, 2> density;
  for (int s = 0; s < 2; ++s) {
    const Quad variance = model.covariances[s];
    const Quad z = Quad(kValue) - Quad(model.means[s]);
    density[s] =
        expq(-z * z / (2 * variance)) / sqrtq(2 * acosq(-1) * variance);
  }
  Scaled step;
  for (int k = 0; k < 4; ++k) {
    step.matrix[k] = Quad(model.transition[k]) * density[k % 2];
  }
  Scaled power{{1, 0, 0, 1}};
  for (int rest = kFrames - 1; rest != 0; rest /= 2) {
    if (rest % 2 != 0) power = Multiply(power, step);
    step = Multiply(step, step);
  }
  Quad sum = 0;
  for (int k = 0; k < 4; ++k) {
    sum += Quad(model.start[k / 2]) * density[k / 2] * power.matrix[k];
  }
  return logq(sum) + Quad(power.exponent) * logq(2);
}

void ExpectNear(double got, Quad want, double tolerance) {
  const double error = static_cast<double>(fabsq((Quad(got) - want) / want));
  EXPECT_LT(error, tolerance);
  testing::Test::RecordProperty("error", std::to_string(error * 1e16) + "e-16");
}

TEST(LongContactTest, FloatScaled) {
  const HmmMixture mixture = {.log_weight = {0}, .components = {TwoStates()}};
  const HmmBank bank = *HmmBank::Create({&mixture, 1});
  ASSERT_EQ(ScoredInDouble({mixture}), 0);
  BankFilter filter(bank, Score::kForward);
  for (int t = 0; t < kFrames; ++t) filter.Step({&kValue, 1});
  double got = 0;
  filter.LogLikelihood({&got, 1});
  ExpectNear(got, LogLikelihood(TwoStates()), 1e-6);
}

TEST(LongContactTest, DoubleScaled) {
  const GaussianHmm model = TwoStates();
  const ScaledModel<double> packed({&model}, UnitScale(1));
  ScaledFilter<double> filter(packed, {}, Score::kForward);
  for (int t = 0; t < kFrames; ++t) filter.Step({&kValue, 1});
  filter.UpdateTotals();
  ExpectNear(filter.log_likelihood(0), LogLikelihood(model), 1e-12);
}

TEST(LongContactTest, DoubleLogDomain) {
  const CompiledHmm hmm = *CompiledHmm::Create(TwoStates());
  ForwardFilter filter(hmm);
  for (int t = 0; t < kFrames; ++t) filter.Step({&kValue, 1});
  ExpectNear(filter.log_likelihood(), LogLikelihood(TwoStates()), 1e-12);
  EXPECT_NEAR(filter.state_posterior()[0] + filter.state_posterior()[1], 1,
              1e-12);
}

}  // namespace
}  // namespace tactus::internal
