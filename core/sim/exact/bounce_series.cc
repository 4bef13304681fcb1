#include "core/sim/exact/bounce_series.h"

#include <algorithm>
#include <cmath>

namespace tactus::internal {
namespace {

constexpr int kSeriesTerms = BounceSeries::kTerms;

// Bernoulli's numbers, the second -1/2.
constexpr std::array<double, kSeriesTerms> kBernoulli = {1, -0.5,      1.0 / 6,
                                                         0, -1.0 / 30, 0};

}  // namespace

BounceSeries::BounceSeries(const BounceChange& change) {
  SetStride(1);
  Add(change);
}

// Newton's backward polynomials, summed by Faulhaber's formula:
// sum over j < m of j^r = sum over i of B_i binomial(r + 1, i) m^(r + 1 - i)
// / (r + 1).
void BounceSeries::SetStride(double stride) {
  stride_ = stride;
  // By powers of the share.
  std::array<double, kSeriesTerms> newton = {1};
  for (int k = 0; k < kSeriesTerms; ++k) {
    if (k > 0) {
      for (int r = k; r > 0; --r) {
        newton[r] = (newton[r - 1] + (k - 1) * newton[r]) / k;
      }
      newton[0] *= (k - 1.0) / k;
    }
    sums_[k].fill(0);
    for (int r = 0; r <= k; ++r) {
      double binomial = 1;
      double power = stride;
      for (int i = 0; i <= r; ++i) {
        sums_[k][r - i] +=
            newton[r] * binomial * kBernoulli[i] * power / (r + 1);
        binomial *= (r + 1.0 - i) / (i + 1);
        power /= stride;
      }
    }
  }
}

void BounceSeries::Differentiate(const BounceChange& change) {
  BounceChange next = change;
  for (BounceChange& difference : differences_) {
    const BounceChange last = difference;
    difference = next;
    for (size_t i = 0; i < next.size(); ++i) next[i] -= last[i];
  }
}

void BounceSeries::FindSums() {
  for (BounceChange& coefficient : coefficients_) coefficient.fill(0);
  const int terms = std::min(count_, kSeriesTerms);
  for (int k = 0; k < terms; ++k) {
    for (int r = 0; r <= k; ++r) {
      for (size_t i = 0; i < coefficients_[r].size(); ++i) {
        coefficients_[r][i] += sums_[k][r] * differences_[k][i];
      }
    }
  }
}

BounceChange BounceSeries::Sum(double share) const {
  BounceChange sum = coefficients_[kSeriesTerms - 1];
  for (int r = kSeriesTerms - 2; r >= 0; --r) {
    for (size_t i = 0; i < sum.size(); ++i) {
      sum[i] = sum[i] * share + coefficients_[r][i];
    }
  }
  for (double& value : sum) value *= share;
  return sum;
}

double BounceSeries::ShareAt(double time) const {
  // All but a straight line: Newton's method squares its error.
  double share = time / (stride_ * differences_[0][kTime]);
  for (int step = 0; step < 4; ++step) {
    double value = 0;
    double slope = 0;
    for (int r = kSeriesTerms - 1; r >= 0; --r) {
      slope = slope * share + value;
      value = value * share + coefficients_[r][kTime];
    }
    slope = slope * share + value;
    const double correction = (value * share - time) / slope;
    share -= correction;
    if (std::abs(correction) < 1e-8) break;
  }
  return share;
}

BounceChange BounceSeries::Miss(const BounceChange& change) const {
  BounceChange miss = change;
  for (const BounceChange& difference : differences_) {
    for (size_t i = 0; i < miss.size(); ++i) miss[i] -= difference[i];
  }
  return miss;
}

void BounceSeries::Add(const BounceChange& change) {
  newest_ = (newest_ + 1) % kKnown;
  known_[newest_] = change;
  Differentiate(change);
  count_ = std::min(count_ + 1, kKnown);
  FindSums();
}

bool BounceSeries::Double() {
  if (count_ < kKnown) return false;
  std::array<BounceChange, kSeriesTerms> kept;
  for (int n = 0; n < kSeriesTerms; ++n) {
    kept[n] = known_[(newest_ + kKnown - 2 * n) % kKnown];
  }
  SetStride(2 * stride_);
  differences_ = {};
  count_ = 0;
  for (int n = kSeriesTerms - 1; n >= 0; --n) {
    newest_ = (newest_ + 1) % kKnown;
    known_[newest_] = kept[n];
    Differentiate(kept[n]);
    ++count_;
  }
  FindSums();
  return true;
}

}  // namespace tactus::internal
