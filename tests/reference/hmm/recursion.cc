#include "tests/reference/hmm/recursion.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tactus::internal {
namespace {

constexpr double kMinusInfinity = -std::numeric_limits<double>::infinity();
// exp() of less is treated as 0, away from denormal numbers.
constexpr double kSmallestExponent = -690;

double LogSum(const CompiledHmm::Incoming& incoming,
              const double* log_probability) {
  double largest = kMinusInfinity;
  for (int i = incoming.first; i < incoming.last; ++i) {
    largest =
        std::max(largest, log_probability[i] +
                              incoming.log_probability[i - incoming.first]);
  }
  if (largest == kMinusInfinity) return kMinusInfinity;
  double sum = 0;
  for (int i = incoming.first; i < incoming.last; ++i) {
    const double exponent = log_probability[i] +
                            incoming.log_probability[i - incoming.first] -
                            largest;
    if (exponent > kNegligibleExponent) sum += std::exp(exponent);
  }
  return largest + std::log(sum);
}

}  // namespace

void Predict(const CompiledHmm& hmm, const Belief& belief,
             const Belief& predicted) {
  for (int j = 0; j < hmm.states(); ++j) {
    const CompiledHmm::Incoming incoming = hmm.incoming(j);
    double sum = 0;
    for (int i = incoming.first; i < incoming.last; ++i) {
      sum += belief.probability[i] * incoming.probability[i - incoming.first];
    }
    predicted.probability[j] = sum;
    predicted.log_probability[j] =
        sum > kTrustedSum ? std::log(sum)
                          : LogSum(incoming, belief.log_probability);
  }
}

double Update(const CompiledHmm& hmm, const Belief& predicted,
              const double* log_density, const Belief& belief) {
  const int n = hmm.states();
  // Differences to the largest density are taken before anything is added to
  // them: far outliers have densities of -1e12 that differ by little.
  const double shift = *std::max_element(log_density, log_density + n);
  double largest = kMinusInfinity;
  for (int j = 0; j < n; ++j) {
    const double l = predicted.log_probability[j] + (log_density[j] - shift);
    belief.log_probability[j] = l;
    largest = std::max(largest, l);
  }
  double sum = 0;
  for (int j = 0; j < n; ++j) {
    const double exponent = belief.log_probability[j] - largest;
    const double p = exponent > kSmallestExponent ? std::exp(exponent) : 0;
    belief.probability[j] = p;
    sum += p;
  }
  const double log_sum = std::log(sum);
  const double scale = 1 / sum;
  for (int j = 0; j < n; ++j) {
    belief.probability[j] *= scale;
    belief.log_probability[j] -= largest + log_sum;
  }
  return shift + (largest + log_sum);
}

void CompensatedSum::Add(double value) {
  const double sum = sum_ + value;
  rest_ += std::abs(sum_) >= std::abs(value) ? (sum_ - sum) + value
                                             : (value - sum) + sum_;
  sum_ = sum;
}

}  // namespace tactus::internal
