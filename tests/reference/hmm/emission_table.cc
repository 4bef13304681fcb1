#include "tests/reference/hmm/emission_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "Eigen/Cholesky"
#include "Eigen/Core"
#include "core/base/limits.h"

namespace tactus::internal {
namespace {

// States evaluated side by side, so that the compiler can vectorise.
constexpr int kLanes = 4;
// Ceiling of the squared Mahalanobis distance: 1e7 frames of it still sum to
// a finite log-likelihood.
constexpr double kMaxSquaredDistance = 1e300;

}  // namespace

EmissionTable::EmissionTable(const GaussianHmm& model)
    : states_(model.states),
      dimensions_(model.dimensions),
      full_(model.covariance_type == CovarianceType::kFull) {
  const int d = dimensions_;
  const int rows = 2 * d + (full_ ? d * (d - 1) / 2 : 0) + 1;
  block_size_ = static_cast<size_t>(rows) * kLanes;
  const int blocks = (states_ + kLanes - 1) / kLanes;
  blocks_.assign(blocks * block_size_, 0.0);
  Eigen::MatrixXd covariance(d, d);
  for (int s = 0; s < states_; ++s) {
    FullCovariance(model, s, covariance.data());
    Eigen::MatrixXd factor = covariance.llt().matrixL();
    if (!full_) factor = covariance.diagonal().cwiseSqrt().asDiagonal();
    double* cell = &blocks_[s / kLanes * block_size_ + s % kLanes];
    const auto put = [&cell](double value) {
      *cell = value;
      cell += kLanes;
    };
    double log_constant = -0.5 * d * std::log(2 * std::numbers::pi);
    for (int i = 0; i < d; ++i) {
      put(model.means[static_cast<size_t>(s) * d + i]);
      put(1 / factor(i, i));
      log_constant -= std::log(factor(i, i));
      for (int j = 0; full_ && j < i; ++j) put(factor(i, j));
    }
    put(log_constant);
  }
}

// Forward substitution z = L^-1 (x - mean), then |z|^2: the squared
// Mahalanobis distance.
template <int kDimensions, bool kFull>
void EmissionTable::Evaluate(const double* x, double* out) const {
  const int d = kDimensions > 0 ? kDimensions : dimensions_;
  constexpr int kRows =
      kDimensions > 0 ? kDimensions : limits::kMaxHmmDimensions;
  double z[kRows][kLanes];
  for (int first = 0; first < states_; first += kLanes) {
    const double* cell = &blocks_[first / kLanes * block_size_];
    double distance[kLanes] = {};
    for (int i = 0; i < d; ++i) {
      const double* mean = cell;
      const double* inverse = cell + kLanes;
      cell += 2 * kLanes;
      for (int k = 0; k < kLanes; ++k) z[i][k] = x[i] - mean[k];
      for (int j = 0; kFull && j < i; ++j) {
        for (int k = 0; k < kLanes; ++k) z[i][k] -= cell[k] * z[j][k];
        cell += kLanes;
      }
      for (int k = 0; k < kLanes; ++k) {
        z[i][k] *= inverse[k];
        distance[k] += z[i][k] * z[i][k];
      }
    }
    const int count = std::min(kLanes, states_ - first);
    for (int k = 0; k < count; ++k) {
      // Written so that NaN takes the ceiling too.
      const double squared =
          distance[k] < kMaxSquaredDistance ? distance[k] : kMaxSquaredDistance;
      out[first + k] = cell[k] - 0.5 * squared;
    }
  }
}

void EmissionTable::LogDensity(std::span<const double> observation,
                               std::span<double> out) const {
  const double* x = observation.data();
  switch (dimensions_) {
    case 1:
      return Evaluate<1, false>(x, out.data());
    case 2:
      return full_ ? Evaluate<2, true>(x, out.data())
                   : Evaluate<2, false>(x, out.data());
    case 3:
      return full_ ? Evaluate<3, true>(x, out.data())
                   : Evaluate<3, false>(x, out.data());
    default:
      return full_ ? Evaluate<0, true>(x, out.data())
                   : Evaluate<0, false>(x, out.data());
  }
}

}  // namespace tactus::internal
