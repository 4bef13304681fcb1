// File: quad_reference.h
//
// Scores of a GaussianHmm in quadruple precision, every sum in logarithms: the
// reference for the scorers of core/hmm, which use float and double.
//
//   const QuadScores want = ScoreInQuad(model, observations);
//   RelativeError(got, want.log_likelihood);
//
// Thread-safe: free functions. Needs GCC and libquadmath.
#pragma once

#include <quadmath.h>

#include <algorithm>
#include <span>
#include <vector>

#include "core/hmm/gaussian_hmm.h"
#include "tests/core/hmm/random_model.h"

namespace tactus::internal {

using Quad = __float128;

// A state's emission in quad precision, by Cholesky.
struct QuadEmission {
  std::vector<Quad> mean;
  std::vector<Quad> factor;
  Quad log_constant;

  QuadEmission(const GaussianHmm& model, int state) {
    const int d = model.dimensions;
    std::vector<double> covariance(d * d);
    FullCovariance(model, state, covariance.data());
    factor.assign(d * d, 0);
    log_constant = -d * logq(2 * acosq(-1)) / 2;
    for (int i = 0; i < d; ++i) {
      mean.push_back(model.means[state * d + i]);
      for (int j = 0; j <= i; ++j) {
        Quad sum = covariance[i * d + j];
        for (int k = 0; k < j; ++k) {
          sum -= factor[i * d + k] * factor[j * d + k];
        }
        factor[i * d + j] = i == j ? sqrtq(sum) : sum / factor[j * d + j];
      }
      log_constant -= logq(factor[i * d + i]);
    }
  }

  Quad LogDensity(std::span<const double> x) const {
    const size_t d = mean.size();
    std::vector<Quad> z(d);
    Quad log_density = log_constant;
    for (size_t i = 0; i < d; ++i) {
      z[i] = Quad(x[i]) - mean[i];
      for (size_t j = 0; j < i; ++j) z[i] -= factor[i * d + j] * z[j];
      z[i] /= factor[i * d + i];
      log_density -= z[i] * z[i] / 2;
    }
    return log_density;
  }
};

struct QuadScores {
  Quad log_likelihood;
  Quad viterbi;
};

// The forward and Viterbi recursions with every sum in logarithms.
inline QuadScores ScoreInQuad(const GaussianHmm& model,
                              const std::vector<double>& observations) {
  const int n = model.states;
  const int frames = static_cast<int>(observations.size()) / model.dimensions;
  const Quad zero = -HUGE_VALQ;
  std::vector<Quad> alpha(n), best(n), log_transition(n * n);
  std::vector<QuadEmission> emissions;
  for (int s = 0; s < n; ++s) emissions.emplace_back(model, s);
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
      for (const Quad term : terms) {
        if (term != zero) sum += expq(term - largest);
      }
      const Quad density =
          emissions[j].LogDensity(Frame(observations, model.dimensions, t));
      next_alpha[j] = largest + logq(fmaxq(sum, 1)) + density;
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

inline double RelativeError(double got, Quad want) {
  return static_cast<double>(fabsq((got - want) / want));
}

}  // namespace tactus::internal
