#include "tests/bench/hmm_models.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "Eigen/Cholesky"
#include "Eigen/Core"

namespace tactus::internal::client {
namespace {

using Matrix =
    Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Vector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

struct Emission {
  Vector mean;
  Matrix factor;  // lower Cholesky factor of the covariance
  long double log_constant;
};

std::vector<Emission> Emissions(const GaussianHmm& model) {
  const int d = model.dimensions;
  std::vector<Emission> emissions(model.states);
  for (int s = 0; s < model.states; ++s) {
    std::vector<double> covariance(static_cast<size_t>(d) * d);
    FullCovariance(model, s, covariance.data());
    Matrix wide(d, d);
    std::ranges::copy(covariance, wide.data());
    Emission& e = emissions[s];
    e.factor = wide.llt().matrixL();
    e.mean = Eigen::Map<const Eigen::VectorXd>(
                 &model.means[static_cast<size_t>(s) * d], d)
                 .cast<long double>();
    e.log_constant = -e.factor.diagonal().array().log().sum() -
                     d * std::log(2 * std::numbers::pi_v<long double>) / 2;
  }
  return emissions;
}

// log(exp(a) + exp(b)).
long double LogSum(long double a, long double b) {
  const long double largest = std::max(a, b);
  const long double smallest = std::min(a, b);
  // Below the rounding of a long double.
  if (!(smallest - largest > -50)) return largest;
  return largest + std::log1p(std::exp(smallest - largest));
}

}  // namespace

GaussianHmm DrawLeftRightModel(int states, int dimensions, Random& random) {
  GaussianHmm model;
  model.states = states;
  model.dimensions = dimensions;
  model.start.assign(states, 0.0);
  model.start[0] = 1;
  model.transition.assign(static_cast<size_t>(states) * states, 0.0);
  for (int i = 0; i < states; ++i) {
    const double stay = i + 1 < states ? random.Uniform(0.9, 0.99) : 1;
    model.transition[static_cast<size_t>(i) * states + i] = stay;
    if (i + 1 < states) {
      model.transition[static_cast<size_t>(i) * states + i + 1] = 1 - stay;
    }
    for (int k = 0; k < dimensions; ++k) {
      model.means.push_back(0.5 * i + random.Gaussian());
    }
    const Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(
        dimensions, dimensions, [&random] { return 0.5 * random.Gaussian(); });
    const Eigen::MatrixXd covariance =
        a * a.transpose() +
        0.1 * Eigen::MatrixXd::Identity(dimensions, dimensions);
    model.covariances.insert(model.covariances.end(), covariance.data(),
                             covariance.data() + covariance.size());
  }
  return model;
}

std::vector<double> DrawTrial(const GaussianHmm& model, int frames,
                              Random& random) {
  const std::vector<Emission> emissions = Emissions(model);
  const int d = model.dimensions;
  std::vector<double> trial;
  for (int t = 0; t < frames; ++t) {
    const auto state = static_cast<int64_t>(t) * model.states / frames;
    const Emission& e = emissions[state];
    const Vector noise =
        Vector::NullaryExpr(d, [&random] { return random.Gaussian(); });
    const Vector x = e.mean + e.factor * noise;
    for (int k = 0; k < d; ++k) trial.push_back(static_cast<double>(x[k]));
  }
  return trial;
}

long double ReferenceScore(const GaussianHmm& model, Score score,
                           const std::vector<double>& observations) {
  const std::vector<Emission> emissions = Emissions(model);
  const int n = model.states;
  const int d = model.dimensions;
  std::vector<long double> log_transition, log_share(n), next(n);
  for (const double p : model.transition) {
    log_transition.push_back(std::log(static_cast<long double>(p)));
  }
  for (size_t t = 0; t * d < observations.size(); ++t) {
    const Eigen::Map<const Eigen::VectorXd> x(&observations[t * d], d);
    for (int j = 0; j < n; ++j) {
      const Emission& e = emissions[j];
      const Vector z = e.factor.triangularView<Eigen::Lower>().solve(
          x.cast<long double>() - e.mean);
      next[j] = t == 0 ? std::log(static_cast<long double>(model.start[j]))
                       : -std::numeric_limits<long double>::infinity();
      for (int i = 0; i < n && t > 0; ++i) {
        if (model.transition[static_cast<size_t>(i) * n + j] == 0) continue;
        const long double way =
            log_share[i] + log_transition[static_cast<size_t>(i) * n + j];
        next[j] = score == Score::kForward ? LogSum(next[j], way)
                                           : std::max(next[j], way);
      }
      next[j] += e.log_constant - z.squaredNorm() / 2;
    }
    log_share.swap(next);
  }
  long double total = log_share[0];
  for (int j = 1; j < n; ++j) {
    total = score == Score::kForward ? LogSum(total, log_share[j])
                                     : std::max(total, log_share[j]);
  }
  return total;
}

}  // namespace tactus::internal::client
