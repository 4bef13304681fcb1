// The filters against the same recursions in quadruple precision, and at the
// edges of double precision.

#include <quadmath.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "core/hmm/forward.h"
#include "gtest/gtest.h"
#include "tests/core/hmm/random_model.h"

namespace tactus {
namespace {

using Quad = __float128;

// The log of a state's density in quad precision, by Cholesky.
Quad QuadLogDensity(const GaussianHmm& model, int state,
                    std::span<const double> x) {
  const int d = model.dimensions;
  std::vector<double> covariance(d * d);
  FullCovariance(model, state, covariance.data());
  std::vector<Quad> factor(d * d, 0);
  std::vector<Quad> z(d);
  Quad log_density = -d * logq(2 * acosq(-1)) / 2;
  for (int i = 0; i < d; ++i) {
    for (int j = 0; j <= i; ++j) {
      Quad sum = covariance[i * d + j];
      for (int k = 0; k < j; ++k) sum -= factor[i * d + k] * factor[j * d + k];
      factor[i * d + j] = i == j ? sqrtq(sum) : sum / factor[j * d + j];
    }
    z[i] = Quad(x[i]) - Quad(model.means[state * d + i]);
    for (int j = 0; j < i; ++j) z[i] -= factor[i * d + j] * z[j];
    z[i] /= factor[i * d + i];
    log_density -= logq(factor[i * d + i]) + z[i] * z[i] / 2;
  }
  return log_density;
}

struct QuadScores {
  Quad log_likelihood;
  Quad viterbi;
};

// The forward and Viterbi recursions with every sum in logarithms.
QuadScores ScoreInQuad(const GaussianHmm& model,
                       const std::vector<double>& observations) {
  const int n = model.states;
  const int frames = static_cast<int>(observations.size()) / model.dimensions;
  const Quad zero = -HUGE_VALQ;
  std::vector<Quad> alpha(n), best(n), log_transition(n * n);
  for (int k = 0; k < n * n; ++k) {
    log_transition[k] =
        model.transition[k] > 0 ? logq(model.transition[k]) : zero;
  }
  for (int t = 0; t < frames; ++t) {
    std::vector<Quad> next_alpha(n), next_best(n);
    for (int j = 0; j < n; ++j) {
      Quad largest = zero;
      Quad path = zero;
      std::vector<Quad> terms;
      if (t == 0) {
        largest = path = logq(model.start[j]);
        terms = {largest};
      }
      for (int i = 0; i < n && t > 0; ++i) {
        if (log_transition[i * n + j] == zero) continue;
        terms.push_back(alpha[i] + log_transition[i * n + j]);
        largest = fmaxq(largest, terms.back());
        path = fmaxq(path, best[i] + log_transition[i * n + j]);
      }
      Quad sum = 0;
      for (const Quad term : terms) sum += expq(term - largest);
      const Quad density =
          QuadLogDensity(model, j, Frame(observations, model.dimensions, t));
      next_alpha[j] = largest + logq(sum) + density;
      next_best[j] = path + density;
    }
    alpha = next_alpha;
    best = next_best;
  }
  const Quad largest = *std::max_element(alpha.begin(), alpha.end());
  Quad sum = 0;
  for (const Quad a : alpha) sum += expq(a - largest);
  return {largest + logq(sum), *std::max_element(best.begin(), best.end())};
}

void ExpectAgreement(const GaussianHmm& model,
                     const std::vector<double>& observations,
                     double tolerance) {
  const CompiledHmm hmm = *CompiledHmm::Create(model);
  ForwardFilter forward(hmm);
  ViterbiFilter viterbi(hmm);
  const int frames = static_cast<int>(observations.size()) / model.dimensions;
  for (int t = 0; t < frames; ++t) {
    forward.Step(Frame(observations, model.dimensions, t));
    viterbi.Step(Frame(observations, model.dimensions, t));
    ASSERT_TRUE(std::isfinite(forward.log_likelihood())) << t;
    ASSERT_TRUE(std::isfinite(viterbi.score())) << t;
    const auto posterior = forward.state_posterior();
    ASSERT_NEAR(std::accumulate(posterior.begin(), posterior.end(), 0.0), 1,
                1e-12);
  }
  EXPECT_GE(forward.log_likelihood() - viterbi.score(),
            -tolerance * std::abs(viterbi.score()));
  const QuadScores want = ScoreInQuad(model, observations);
  const double forward_error = static_cast<double>(fabsq(
      (forward.log_likelihood() - want.log_likelihood) / want.log_likelihood));
  const double viterbi_error = static_cast<double>(
      fabsq((viterbi.score() - want.viterbi) / want.viterbi));
  EXPECT_LT(forward_error, tolerance);
  EXPECT_LT(viterbi_error, tolerance);
  testing::Test::RecordProperty("forward_error_e16",
                                std::to_string(forward_error * 1e16));
  testing::Test::RecordProperty("viterbi_error_e16",
                                std::to_string(viterbi_error * 1e16));
}

constexpr double kTolerance = 1e-12;

TEST(PrecisionTest, LongStreamLeftRight) {
  Random random(41);
  const GaussianHmm model =
      RandomModel(10, 3, CovarianceType::kFull, true, random);
  ExpectAgreement(model, RandomObservations(model, 10'000, random), kTolerance);
}

TEST(PrecisionTest, LongStreamErgodic) {
  Random random(42);
  const GaussianHmm model =
      RandomModel(4, 2, CovarianceType::kFull, false, random);
  ExpectAgreement(model, RandomObservations(model, 10'000, random), kTolerance);
}

TEST(PrecisionTest, HundredThousandFrames) {
  Random random(43);
  const GaussianHmm model =
      RandomModel(2, 1, CovarianceType::kSpherical, false, random);
  ExpectAgreement(model, RandomObservations(model, 100'000, random),
                  kTolerance);
}

// Every state's density underflows and the states' order is decided by
// exponents far beyond double's range; then the stream returns to the state
// that had fallen 1e11 nats behind.
TEST(PrecisionTest, OutliersOfAMillionSigma) {
  Random random(44);
  for (const bool left_right : {false, true}) {
    const GaussianHmm model =
        RandomModel(5, 2, CovarianceType::kFull, left_right, random);
    std::vector<double> x = RandomObservations(model, 100, random);
    for (const int t : {0, 17, 18, 60, 99}) {
      x[2 * t] = 1e6;
      x[2 * t + 1] = t % 2 == 0 ? -1e6 : 1e6;
    }
    ExpectAgreement(model, x, kTolerance);
  }
}

// The first state lags by hundreds of nats a frame until only it explains
// what follows: a filter that lets it underflow is wrong by thousands of nats.
TEST(PrecisionTest, StatesFarBehindAreNotLost) {
  GaussianHmm model;
  model.states = 2;
  model.dimensions = 1;
  model.covariance_type = CovarianceType::kSpherical;
  model.start = {0.5, 0.5};
  model.transition = {0.9, 0.1, 0, 1};
  model.means = {0, 100};
  model.covariances = {1, 1};
  std::vector<double> x(10, 80.0);
  x.resize(40, 0.0);
  ExpectAgreement(model, x, kTolerance);
}

TEST(PrecisionTest, IdenticalStates) {
  Random random(45);
  GaussianHmm model = RandomModel(6, 2, CovarianceType::kFull, false, random);
  for (int s = 1; s < 6; ++s) {
    std::copy_n(model.means.begin(), 2, model.means.begin() + 2 * s);
    std::copy_n(model.covariances.begin(), 4,
                model.covariances.begin() + 4 * s);
  }
  ExpectAgreement(model, RandomObservations(model, 500, random), kTolerance);
}

// One direction's variance is 1e-12 of the other's.
TEST(PrecisionTest, NearSingularCovariances) {
  Random random(46);
  GaussianHmm model = RandomModel(3, 2, CovarianceType::kFull, true, random);
  for (int s = 0; s < 3; ++s) {
    double* c = &model.covariances[4 * s];
    c[0] = c[3] = 1;
    c[1] = c[2] = 1 - 0x1p-40;
  }
  std::vector<double> x = RandomObservations(model, 200, random);
  for (size_t k = 0; k < x.size(); k += 2) x[k + 1] = x[k];
  ExpectAgreement(model, x, kTolerance);
}

TEST(PrecisionTest, ConstantFeaturesAndTinyNumbers) {
  Random random(47);
  GaussianHmm model =
      RandomModel(3, 2, CovarianceType::kDiagonal, true, random);
  const double denormal = std::numeric_limits<double>::denorm_min();
  model.means = {0, 0, denormal, 1e-310, -1e-300, 0};
  model.covariances = {1e-300, 1, 1e-290, 2, 1e-280, 1};
  std::vector<double> x;
  for (int t = 0; t < 50; ++t) {
    x.push_back(1e-150 * (t % 3));
    x.push_back(denormal * t);
  }
  ExpectAgreement(model, x, kTolerance);
}

TEST(PrecisionTest, SingleFrameSingleState) {
  Random random(48);
  const GaussianHmm model =
      RandomModel(1, 1, CovarianceType::kFull, true, random);
  ExpectAgreement(model, {0.3}, kTolerance);
}

// What no double can hold still leaves finite numbers behind.
TEST(PrecisionTest, NumbersBeyondRangeDoNotSpread) {
  Random random(49);
  for (const int d : {1, 2, 3, 5}) {
    const GaussianHmm model =
        RandomModel(4, d, CovarianceType::kFull, true, random);
    const CompiledHmm hmm = *CompiledHmm::Create(model);
    ForwardFilter forward(hmm);
    ViterbiFilter viterbi(hmm);
    const std::vector<double> good = RandomObservations(model, 1, random);
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity(),
                             -std::numeric_limits<double>::infinity(),
                             std::numeric_limits<double>::max(), 1e200}) {
      std::vector<double> x = good;
      x[0] = bad;
      forward.Step(x);
      viterbi.Step(x);
      forward.Step(good);
      viterbi.Step(good);
      EXPECT_TRUE(std::isfinite(forward.log_likelihood())) << bad;
      EXPECT_TRUE(std::isfinite(viterbi.score())) << bad;
      const auto posterior = forward.state_posterior();
      EXPECT_NEAR(std::accumulate(posterior.begin(), posterior.end(), 0.0), 1,
                  1e-12);
    }
  }
}

}  // namespace
}  // namespace tactus
