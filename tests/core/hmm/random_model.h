// File: random_model.h
//
// Random models and observation sequences for the tests of core/hmm.
// Not thread-safe: the caller's Random is advanced.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "Eigen/Core"
#include "core/base/random.h"
#include "core/hmm/gaussian_hmm.h"
#include "core/hmm/mixture.h"
#include "core/hmm/scaled_model.h"

namespace tactus::internal {

inline void Normalise(double* values, int count) {
  double sum = 0;
  for (int k = 0; k < count; ++k) sum += values[k];
  for (int k = 0; k < count; ++k) values[k] /= sum;
}

// Left-right models step to the next state or stay; ergodic ones go anywhere.
inline GaussianHmm RandomModel(int n, int d, CovarianceType type,
                               bool left_right, Random& random) {
  GaussianHmm model;
  model.states = n;
  model.dimensions = d;
  model.covariance_type = type;
  for (int i = 0; i < n; ++i) {
    model.start.push_back(random.Uniform(0.05, 1));
    for (int j = 0; j < n; ++j) {
      const bool allowed = !left_right || j == i || j == i + 1;
      model.transition.push_back(allowed ? random.Uniform(0.05, 1) : 0);
    }
    Normalise(&model.transition[static_cast<size_t>(i) * n], n);
    for (int k = 0; k < d; ++k) {
      model.means.push_back(2 * random.Gaussian() + (left_right ? i : 0));
    }
    if (type == CovarianceType::kFull) {
      const Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(
          d, d, [&random]() { return random.Gaussian(); });
      const Eigen::MatrixXd c =
          a * a.transpose() + 0.2 * Eigen::MatrixXd::Identity(d, d);
      model.covariances.insert(model.covariances.end(), c.data(),
                               c.data() + c.size());
    } else {
      const size_t width = CovarianceSize(type, d);
      for (size_t k = 0; k < width; ++k) {
        model.covariances.push_back(random.Uniform(0.2, 2));
      }
    }
  }
  Normalise(model.start.data(), n);
  return model;
}

// A random walk over the model's range: [frames x D].
inline std::vector<double> RandomObservations(const GaussianHmm& model,
                                              int frames, Random& random) {
  std::vector<double> out;
  for (int t = 0; t < frames; ++t) {
    const int state =
        std::min(model.states - 1, t * model.states / std::max(frames, 1));
    for (int k = 0; k < model.dimensions; ++k) {
      out.push_back(
          model.means[static_cast<size_t>(state) * model.dimensions + k] +
          random.Gaussian());
    }
  }
  return out;
}

inline std::span<const double> Frame(const std::vector<double>& observations,
                                     int dimensions, int t) {
  return std::span<const double>(observations)
      .subspan(static_cast<size_t>(t) * dimensions, dimensions);
}

// The number of components that HmmBank scores in double because float is not
// precise enough.
inline int ScoredInDouble(const std::vector<HmmMixture>& categories) {
  std::vector<const GaussianHmm*> models;
  for (const HmmMixture& category : categories) {
    for (const GaussianHmm& model : category.components) {
      models.push_back(&model);
    }
  }
  const std::vector<double> scale = BalancedScale(models);
  return static_cast<int>(std::ranges::count_if(
      models,
      [&](const GaussianHmm* model) { return !FitsFloat(*model, scale); }));
}

}  // namespace tactus::internal
