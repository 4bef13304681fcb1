#include "tests/reference/hmm/forward_filter.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "Eigen/LU"
#include "gtest/gtest.h"
#include "tests/core/hmm/random_model.h"
#include "tests/reference/hmm/viterbi_filter.h"

namespace tactus::internal {
namespace {

constexpr CovarianceType kTypes[] = {CovarianceType::kFull,
                                     CovarianceType::kDiagonal,
                                     CovarianceType::kSpherical};

// log N(x; mean, covariance) by the textbook formula, with an explicit inverse
// and determinant.
double TextbookLogDensity(const GaussianHmm& model, int state,
                          std::span<const double> x) {
  const int d = model.dimensions;
  Eigen::MatrixXd covariance(d, d);
  FullCovariance(model, state, covariance.data());
  Eigen::VectorXd z(d);
  for (int k = 0; k < d; ++k) z[k] = x[k] - model.means[state * d + k];
  return -0.5 * (z.dot(covariance.inverse() * z) +
                 std::log(covariance.determinant()) + d * std::log(2 * M_PI));
}

// Sum and maximum of p(observations, path) over every one of the N^T paths.
struct Enumerated {
  double sum = 0;
  double largest = 0;
};
Enumerated EnumeratePaths(const GaussianHmm& model,
                          const std::vector<double>& observations, int frames,
                          int missing = -1) {
  const int n = model.states;
  Enumerated result;
  std::vector<int> path(frames, 0);
  for (;;) {
    double p = model.start[path[0]];
    for (int t = 0; t < frames; ++t) {
      if (t > 0) p *= model.transition[path[t - 1] * n + path[t]];
      if (t != missing) {
        p *= std::exp(TextbookLogDensity(
            model, path[t], Frame(observations, model.dimensions, t)));
      }
    }
    result.sum += p;
    result.largest = std::max(result.largest, p);
    int t = 0;
    while (t < frames && ++path[t] == n) path[t++] = 0;
    if (t == frames) return result;
  }
}

TEST(EmissionTest, MatchesTheTextbookFormula) {
  Random random(11);
  for (const CovarianceType type : kTypes) {
    for (const int d : {1, 2, 3, 4, 16}) {
      const GaussianHmm model = RandomModel(10, d, type, false, random);
      const EmissionTable table(model);
      const std::vector<double> x = RandomObservations(model, 20, random);
      std::vector<double> out(10);
      for (int t = 0; t < 20; ++t) {
        table.LogDensity(Frame(x, d, t), out);
        for (int s = 0; s < 10; ++s) {
          const double want = TextbookLogDensity(model, s, Frame(x, d, t));
          EXPECT_NEAR(out[s], want, 1e-10 * std::abs(want)) << d << " " << s;
        }
      }
    }
  }
}

TEST(ForwardFilterTest, MatchesTheSumOverAllPaths) {
  Random random(12);
  constexpr int kFrames = 6;
  for (const CovarianceType type : kTypes) {
    for (const int d : {1, 2, 3}) {
      for (const bool left_right : {false, true}) {
        const GaussianHmm model = RandomModel(4, d, type, left_right, random);
        const CompiledHmm hmm = *CompiledHmm::Create(model);
        const std::vector<double> x =
            RandomObservations(model, kFrames, random);
        ForwardFilter forward(hmm);
        ViterbiFilter viterbi(hmm);
        for (int t = 0; t < kFrames; ++t) {
          forward.Step(Frame(x, d, t));
          viterbi.Step(Frame(x, d, t));
          const Enumerated want = EnumeratePaths(model, x, t + 1);
          EXPECT_NEAR(forward.log_likelihood(), std::log(want.sum),
                      1e-11 * std::abs(std::log(want.sum)));
          EXPECT_NEAR(viterbi.score(), std::log(want.largest),
                      1e-11 * std::abs(std::log(want.largest)));
        }
      }
    }
  }
}

TEST(ForwardFilterTest, SkipSumsOverTheMissingObservation) {
  Random random(13);
  constexpr int kFrames = 5;
  for (int missing = 0; missing < kFrames; ++missing) {
    const GaussianHmm model =
        RandomModel(4, 2, CovarianceType::kFull, missing % 2 == 0, random);
    const CompiledHmm hmm = *CompiledHmm::Create(model);
    const std::vector<double> x = RandomObservations(model, kFrames, random);
    ForwardFilter forward(hmm);
    ViterbiFilter viterbi(hmm);
    for (int t = 0; t < kFrames; ++t) {
      if (t == missing) {
        forward.Skip(1);
        viterbi.Skip(1);
      } else {
        forward.Step(Frame(x, 2, t));
        viterbi.Step(Frame(x, 2, t));
      }
    }
    const Enumerated want = EnumeratePaths(model, x, kFrames, missing);
    EXPECT_NEAR(forward.log_likelihood(), std::log(want.sum), 1e-11);
    EXPECT_NEAR(viterbi.score(), std::log(want.largest), 1e-11);
  }
}

}  // namespace
}  // namespace tactus::internal
