#include "core/nearest/pca_nearest.h"

#include <cmath>

#include "Eigen/Eigenvalues"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"

namespace tactus::internal {
namespace {

absl::Status CheckInput(const Eigen::MatrixXd& samples,
                        const std::vector<int>& labels, double share) {
  if (!(share > 0 && share <= 1)) {
    return InvalidConfig("variance_share", share, "above 0 and at most 1");
  }
  if (samples.rows() < 1 || samples.cols() < 1) {
    return InvalidTrainingData(absl::StrCat("samples are ", samples.rows(),
                                            " x ", samples.cols(),
                                            "; at least 1 x 1 is needed"));
  }
  if (static_cast<Eigen::Index>(labels.size()) != samples.rows()) {
    return InvalidTrainingData(absl::StrCat(labels.size(), " labels for ",
                                            samples.rows(),
                                            " samples; one each is needed"));
  }
  if (!samples.allFinite()) {
    return InvalidTrainingData(
        "samples hold a number that is not finite; all must be");
  }
  return absl::OkStatus();
}

// The leading principal axes of `centred` [samples x features] that hold a
// fraction `share` of its variance: [features x components].
Eigen::MatrixXd PrincipalAxes(const Eigen::MatrixXd& centred, double share) {
  // The products of samples and those of features have the same eigenvalues;
  // the smaller matrix is decomposed.
  const bool by_samples = centred.rows() < centred.cols();
  const Eigen::MatrixXd products =
      by_samples ? Eigen::MatrixXd(centred * centred.transpose())
                 : Eigen::MatrixXd(centred.transpose() * centred);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(products);
  // Ascending order. Rounding may make the smallest negative.
  const Eigen::VectorXd values = solver.eigenvalues().cwiseMax(0.0);
  const double total = values.sum();
  Eigen::Index components = 0;
  double kept = 0;
  while (kept < share * total && components < values.size() &&
         values[values.size() - 1 - components] > 0) {
    kept += values[values.size() - 1 - components];
    ++components;
  }
  Eigen::MatrixXd axes =
      solver.eigenvectors().rightCols(components).rowwise().reverse();
  if (by_samples) axes = (centred.transpose() * axes).colwise().normalized();
  return axes;
}

}  // namespace

absl::StatusOr<PcaNearest> PcaNearest::Fit(const Eigen::MatrixXd& samples,
                                           const std::vector<int>& labels,
                                           double variance_share) {
  if (absl::Status status = CheckInput(samples, labels, variance_share);
      !status.ok()) {
    return status;
  }
  PcaNearest fitted;
  fitted.mean_ = samples.colwise().mean();
  const Eigen::MatrixXd centred = samples.rowwise() - fitted.mean_;
  if (!std::isfinite(centred.squaredNorm())) {
    return InvalidTrainingData(
        "samples hold numbers whose squares overflow; smaller ones are needed");
  }
  fitted.basis_ = PrincipalAxes(centred, variance_share);
  fitted.samples_ = (centred * fitted.basis_).transpose();
  fitted.labels_ = labels;
  return fitted;
}

absl::StatusOr<PcaNearest::Match> PcaNearest::Predict(
    const Eigen::VectorXd& vector) const {
  if (vector.size() != features() || !vector.allFinite()) {
    return InvalidTrainingData(
        absl::StrCat("the vector to classify has ", vector.size(), " entries; ",
                     features(), " finite ones are needed"));
  }
  const Eigen::VectorXd projected =
      ((vector.transpose() - mean_) * basis_).transpose();
  Eigen::Index nearest = 0;
  const double squared = (samples_.colwise() - projected)
                             .colwise()
                             .squaredNorm()
                             .minCoeff(&nearest);
  return Match{labels_[nearest], static_cast<int>(nearest), std::sqrt(squared)};
}

}  // namespace tactus::internal
