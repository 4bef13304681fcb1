#include "client/drivers/icub_skin/unroll.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "Eigen/Eigenvalues"
#include "Eigen/QR"

namespace tactus::internal::client::icub {
namespace {

// Normals of a flat patch have less than this fraction of their squares in
// their second direction: a patch that bends by less than about 40 degrees.
constexpr double kCurved = 0.03;
// No part of a robot that carries skin is thicker.
constexpr double kMaxRadiusM = 0.5;

}  // namespace

std::vector<Eigen::Vector3d> Unroll(
    const std::vector<Eigen::Vector3d>& points,
    const std::vector<Eigen::Vector3d>& normals) {
  if (points.size() < 3 || normals.size() != points.size()) return points;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& normal : normals) {
    spread += normal * normal.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  // Rising: along the axis, across it, and the most usual normal.
  const Eigen::Vector3d squares = solver.eigenvalues();
  if (!(squares[1] > kCurved * squares.sum())) return points;
  const Eigen::Matrix3d frame = solver.eigenvectors();
  // The circle through the points across the axis, by least squares:
  // 2 a u + 2 b v + c = u^2 + v^2.
  const auto count = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXd left(count, 3);
  Eigen::VectorXd right(count);
  std::vector<Eigen::Vector3d> local;
  for (Eigen::Index i = 0; i < count; ++i) {
    local.push_back(frame.transpose() * points[static_cast<size_t>(i)]);
    const double u = local.back()[1];
    const double v = local.back()[2];
    left.row(i) << 2 * u, 2 * v, 1;
    right[i] = u * u + v * v;
  }
  const Eigen::Vector3d circle = left.colPivHouseholderQr().solve(right);
  const double square =
      circle[2] + circle[0] * circle[0] + circle[1] * circle[1];
  if (!(square > 0 && square < kMaxRadiusM * kMaxRadiusM)) return points;
  const double radius = std::sqrt(square);
  std::vector<double> angles;
  for (const Eigen::Vector3d& point : local) {
    angles.push_back(std::atan2(point[2] - circle[1], point[1] - circle[0]));
  }
  // The widest gap; the last one goes around.
  std::vector<double> sorted = angles;
  std::sort(sorted.begin(), sorted.end());
  double begin = sorted[0];
  double widest = sorted[0] + 2 * std::numbers::pi - sorted.back();
  for (size_t i = 1; i < sorted.size(); ++i) {
    if (sorted[i] - sorted[i - 1] <= widest) continue;
    widest = sorted[i] - sorted[i - 1];
    begin = sorted[i];
  }
  std::vector<Eigen::Vector3d> flat;
  for (size_t i = 0; i < local.size(); ++i) {
    double angle = angles[i] - begin;
    if (angle < 0) angle += 2 * std::numbers::pi;
    flat.emplace_back(radius * angle, local[i][0], 0);
  }
  return flat;
}

}  // namespace tactus::internal::client::icub
