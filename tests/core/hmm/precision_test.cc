// The scorers in their three arithmetics against quadruple precision, and at
// the limits of each: scaled in float (the bank), scaled in double, logarithms
// in double.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "core/hmm/hmm_bank.h"
#include "core/hmm/scaled_filter.h"
#include "gtest/gtest.h"
#include "tests/core/hmm/quad_reference.h"
#include "tests/core/hmm/random_model.h"
#include "tests/reference/hmm/forward_filter.h"
#include "tests/reference/hmm/viterbi_filter.h"

namespace tactus::internal {
namespace {

constexpr double kTolerance = 1e-12;
constexpr double kFloatTolerance = 1e-6;

// Scores of one model by one implementation.
struct Scored {
  const char* name;
  double tolerance;
  double log_likelihood = 0;
  double viterbi = 0;
};

// The log-domain filters.
Scored ScoreInLogarithms(const GaussianHmm& model,
                         const std::vector<double>& observations) {
  const CompiledHmm hmm = *CompiledHmm::Create(model);
  ForwardFilter forward(hmm);
  ViterbiFilter viterbi(hmm);
  const int d = model.dimensions;
  for (int t = 0; t * d < static_cast<int>(observations.size()); ++t) {
    forward.Step(Frame(observations, d, t));
    viterbi.Step(Frame(observations, d, t));
    EXPECT_TRUE(std::isfinite(forward.log_likelihood())) << t;
    EXPECT_TRUE(std::isfinite(viterbi.score())) << t;
    const auto posterior = forward.state_posterior();
    EXPECT_NEAR(std::accumulate(posterior.begin(), posterior.end(), 0.0), 1,
                1e-12);
  }
  return {"logarithms", kTolerance, forward.log_likelihood(), viterbi.score()};
}

Scored ScoreScaled(const GaussianHmm& model,
                   const std::vector<double>& observations) {
  const ScaledModel<double> scaled({&model}, UnitScale(model.dimensions));
  Scored scored{"double", kTolerance};
  for (const Score score : {Score::kForward, Score::kViterbi}) {
    ScaledFilter<double> filter(scaled, {}, score);
    const int d = model.dimensions;
    for (int t = 0; t * d < static_cast<int>(observations.size()); ++t) {
      filter.Step(Frame(observations, d, t));
    }
    filter.UpdateTotals();
    (score == Score::kForward ? scored.log_likelihood : scored.viterbi) =
        filter.log_likelihood(0);
  }
  return scored;
}

Scored ScoreInBank(const GaussianHmm& model,
                   const std::vector<double>& observations) {
  const HmmMixture mixture = {.log_weight = {0}, .components = {model}};
  const HmmBank bank = *HmmBank::Create({&mixture, 1});
  Scored scored{"bank", kFloatTolerance};
  for (const Score score : {Score::kForward, Score::kViterbi}) {
    BankFilter filter(bank, score);
    double got = 0;
    const int d = model.dimensions;
    for (int t = 0; t * d < static_cast<int>(observations.size()); ++t) {
      filter.Step(Frame(observations, d, t));
      filter.LogLikelihood({&got, 1});
      EXPECT_TRUE(std::isfinite(got)) << t;
    }
    (score == Score::kForward ? scored.log_likelihood : scored.viterbi) = got;
  }
  return scored;
}

void ExpectAgreement(const GaussianHmm& model,
                     const std::vector<double>& observations) {
  const QuadScores want = ScoreInQuad(model, observations);
  for (const Scored& scored :
       {ScoreInLogarithms(model, observations),
        ScoreScaled(model, observations), ScoreInBank(model, observations)}) {
    SCOPED_TRACE(scored.name);
    EXPECT_GE(scored.log_likelihood - scored.viterbi,
              -scored.tolerance * std::abs(scored.viterbi));
    const double forward_error =
        RelativeError(scored.log_likelihood, want.log_likelihood);
    const double viterbi_error = RelativeError(scored.viterbi, want.viterbi);
    EXPECT_LT(forward_error, scored.tolerance);
    EXPECT_LT(viterbi_error, scored.tolerance);
    testing::Test::RecordProperty(
        std::string(scored.name) + "_forward_error_e16",
        std::to_string(forward_error * 1e16));
    testing::Test::RecordProperty(
        std::string(scored.name) + "_viterbi_error_e16",
        std::to_string(viterbi_error * 1e16));
  }
}

TEST(PrecisionTest, LongStreamLeftRight) {
  Random random(41);
  const GaussianHmm model =
      RandomModel(10, 3, CovarianceType::kFull, true, random);
  ExpectAgreement(model, RandomObservations(model, 10'000, random));
}

TEST(PrecisionTest, LongStreamErgodic) {
  Random random(42);
  const GaussianHmm model =
      RandomModel(4, 2, CovarianceType::kFull, false, random);
  ExpectAgreement(model, RandomObservations(model, 10'000, random));
}

TEST(PrecisionTest, HundredThousandFrames) {
  Random random(43);
  const GaussianHmm model =
      RandomModel(2, 1, CovarianceType::kSpherical, false, random);
  ExpectAgreement(model, RandomObservations(model, 100'000, random));
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
    ExpectAgreement(model, x);
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
  ExpectAgreement(model, x);
}

TEST(PrecisionTest, IdenticalStates) {
  Random random(45);
  GaussianHmm model = RandomModel(6, 2, CovarianceType::kFull, false, random);
  for (int s = 1; s < 6; ++s) {
    std::copy_n(model.means.begin(), 2, model.means.begin() + 2 * s);
    std::copy_n(model.covariances.begin(), 4,
                model.covariances.begin() + 4 * s);
  }
  ExpectAgreement(model, RandomObservations(model, 500, random));
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
  ExpectAgreement(model, x);
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
  ExpectAgreement(model, x);
}

TEST(PrecisionTest, SingleFrameSingleState) {
  Random random(48);
  const GaussianHmm model =
      RandomModel(1, 1, CovarianceType::kFull, true, random);
  ExpectAgreement(model, {0.3});
}

// After numbers beyond the range of double, all results are finite.
TEST(PrecisionTest, NumbersBeyondRangeDoNotSpread) {
  Random random(49);
  for (const int d : {1, 2, 3, 5}) {
    const GaussianHmm model =
        RandomModel(4, d, CovarianceType::kFull, true, random);
    const CompiledHmm hmm = *CompiledHmm::Create(model);
    ForwardFilter forward(hmm);
    ViterbiFilter viterbi(hmm);
    const HmmMixture mixture = {.log_weight = {0}, .components = {model}};
    const HmmBank bank = *HmmBank::Create({&mixture, 1});
    BankFilter bank_forward(bank, Score::kForward);
    BankFilter bank_viterbi(bank, Score::kViterbi);
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
      for (BankFilter* filter : {&bank_forward, &bank_viterbi}) {
        filter->Step(x);
        filter->Step(good);
        double score = 0;
        filter->LogLikelihood({&score, 1});
        EXPECT_TRUE(std::isfinite(score)) << bad;
      }
      const auto posterior = forward.state_posterior();
      EXPECT_NEAR(std::accumulate(posterior.begin(), posterior.end(), 0.0), 1,
                  1e-12);
    }
  }
}

// Each feature in its own unit, from 1e-30 to 1e30.
TEST(PrecisionTest, UnitsFarApart) {
  Random random(50);
  for (const double power : {-30.0, -12.0, 12.0, 30.0}) {
    GaussianHmm model = RandomModel(4, 3, CovarianceType::kFull, true, random);
    std::vector<double> x = RandomObservations(model, 300, random);
    const double unit[] = {std::pow(10, power), 1, std::pow(10, -power)};
    for (size_t k = 0; k < x.size(); ++k) x[k] *= unit[k % 3];
    for (size_t k = 0; k < model.means.size(); ++k) {
      model.means[k] *= unit[k % 3];
    }
    for (size_t k = 0; k < model.covariances.size(); ++k) {
      model.covariances[k] *= unit[k % 3] * unit[k / 3 % 3];
    }
    ExpectAgreement(model, x);
  }
}

// A transition of probability 1e-300 is taken when there is no other.
TEST(PrecisionTest, TransitionsThatFloatCannotHold) {
  GaussianHmm model;
  model.states = 3;
  model.dimensions = 1;
  model.covariance_type = CovarianceType::kSpherical;
  model.start = {1, 1e-300, 0};
  model.transition = {1, 1e-300, 0, 0, 1, 1e-200, 0, 0, 1};
  model.means = {0, 50, 100};
  model.covariances = {1, 1, 1};
  std::vector<double> x(20, 0.1);
  x.resize(40, 49.9);
  x.resize(60, 100.2);
  ExpectAgreement(model, x);
}

// A stream far from the origin: float alone could not distinguish its values.
TEST(PrecisionTest, FeaturesFarFromZero) {
  Random random(51);
  GaussianHmm model = RandomModel(4, 2, CovarianceType::kFull, true, random);
  std::vector<double> x = RandomObservations(model, 500, random);
  for (double& value : x) value += 1e8;
  for (double& mean : model.means) mean += 1e8;
  ExpectAgreement(model, x);
}

TEST(PrecisionTest, HundredThousandFramesOfThreeFeatures) {
  Random random(52);
  const GaussianHmm model =
      RandomModel(3, 3, CovarianceType::kFull, true, random);
  ExpectAgreement(model, RandomObservations(model, 100'000, random));
}

// After a number beyond the range of double, the bank keeps its prediction, as
// if the frame had been lost.
TEST(PrecisionTest, NumbersBeyondRangeLeaveTheBelief) {
  Random random(53);
  const HmmMixture mixture = {
      .log_weight = {0},
      .components = {RandomModel(4, 2, CovarianceType::kFull, true, random)}};
  const HmmBank bank = *HmmBank::Create({&mixture, 1});
  const std::vector<double> x =
      RandomObservations(mixture.components[0], 40, random);
  const double bad[] = {std::numeric_limits<double>::quiet_NaN(), 0};
  for (const Score score : {Score::kForward, Score::kViterbi}) {
    const ScaledModel<double> model({&mixture.components[0]}, UnitScale(2));
    ScaledFilter<double> lost(model, {}, score);
    ScaledFilter<double> spoilt(model, {}, score);
    for (int t = 0; t < 20; ++t) {
      lost.Step(Frame(x, 2, t));
      spoilt.Step(Frame(x, 2, t));
    }
    lost.Skip(1);
    spoilt.Step(bad);
    lost.UpdateTotals();
    spoilt.UpdateTotals();
    EXPECT_EQ(lost.total(0), spoilt.total(0));
  }
}

// Every number of a long contact is rounded the same way when a feature is
// constant; the sum must not drift: neither of one bit a frame, nor of 2^13,
// nor of densities of 2^98.
TEST(PrecisionTest, MillionEqualFrames) {
  constexpr int kFrames = 1'000'000;
  for (const double unit : {1.0, 1e-30}) {
    const double means[] = {0, 100 * unit};
    const double variance = 0.7 * unit * unit;
    const double x[] = {0.1 * unit};
    std::vector<HmmMixture> categories;
    for (const double mean : means) {
      GaussianHmm model;
      model.states = 2;
      model.dimensions = 1;
      model.covariance_type = CovarianceType::kSpherical;
      model.start = {0.3, 0.7};
      model.transition = {0.9, 0.1, 0.1, 0.9};
      model.means = {mean, mean};
      model.covariances = {variance, variance};
      categories.push_back({.log_weight = {0}, .components = {model}});
    }
    const HmmBank bank = *HmmBank::Create(categories);
    EXPECT_EQ(ScoredInDouble(categories), 0);
    BankFilter filter(bank, Score::kForward);
    for (int t = 0; t < kFrames; ++t) filter.Step(x);
    std::vector<double> got(2);
    filter.LogLikelihood(got);
    for (int c = 0; c < 2; ++c) {
      const double far = x[0] - means[c];
      const double want =
          -0.5 * kFrames *
          (std::log(2 * M_PI * variance) + far * far / variance);
      EXPECT_NEAR(got[c], want, kFloatTolerance * std::abs(want))
          << "unit " << unit << " mean " << means[c];
    }
  }
}

}  // namespace
}  // namespace tactus::internal
