#include "core/hmm/floored_covariance.h"

#include <algorithm>
#include <cstddef>

#include "Eigen/Core"
#include "Eigen/Eigenvalues"

namespace tactus::internal {
namespace {

constexpr double kSmallestEigenvalueRatio = 1e-10;

bool SetFull(const std::vector<double>& covariance, double floor, int d,
             double* out) {
  const Eigen::Map<const Eigen::MatrixXd> sample(covariance.data(), d, d);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(sample);
  const Eigen::VectorXd& values = solver.eigenvalues();
  floor = std::max(floor, kSmallestEigenvalueRatio * values.maxCoeff());
  if (values.minCoeff() >= floor) {
    std::ranges::copy(covariance, out);
    return false;
  }
  const Eigen::MatrixXd raised = solver.eigenvectors() *
                                 values.cwiseMax(floor).asDiagonal() *
                                 solver.eigenvectors().transpose();
  for (int a = 0; a < d; ++a) {
    for (int b = 0; b <= a; ++b) out[a * d + b] = out[b * d + a] = raised(a, b);
  }
  return true;
}

}  // namespace

bool SetFlooredCovariance(const std::vector<double>& covariance, double floor,
                          int state, GaussianHmm& model) {
  const int d = model.dimensions;
  const size_t width = CovarianceSize(model.covariance_type, d);
  double* out = &model.covariances[state * width];
  if (model.covariance_type == CovarianceType::kFull) {
    return SetFull(covariance, floor, d, out);
  }
  std::fill(out, out + width, 0.0);
  for (int k = 0; k < d; ++k) {
    const double variance = covariance[k * d + k];
    if (model.covariance_type == CovarianceType::kDiagonal) {
      out[k] = variance;
    } else {
      out[0] += variance / d;
    }
  }
  bool raised = false;
  for (size_t k = 0; k < width; ++k) {
    if (out[k] < floor) {
      out[k] = floor;
      raised = true;
    }
  }
  return raised;
}

}  // namespace tactus::internal
