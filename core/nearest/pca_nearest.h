// File: pca_nearest.h
//
// The paper's baseline: principal component analysis that keeps a fraction of
// the variance (95 %), then the label of the nearest training sample (1-NN).
// Samples are complete trials as vectors of fixed length; it does not stream.
//
//   TACTUS_ASSIGN_OR_RETURN(PcaNearest nearest,
//                           PcaNearest::Fit(samples, labels, 0.95));
//   TACTUS_ASSIGN_OR_RETURN(PcaNearest::Match match, nearest.Predict(vector));
//
// Thread-safe: immutable. Owns copies of what it needs.
#pragma once

#include <vector>

#include "Eigen/Core"
#include "absl/status/statusor.h"

namespace tactus::internal {

class PcaNearest {
 public:
  struct Match {
    int label = 0;        // of the nearest sample
    int sample = 0;       // its row; the first of several equally near ones
    double distance = 0;  // Euclidean, in the components kept
  };

  // samples: [samples x features], finite; labels: [samples]; variance_share
  // in (0, 1]. Keeps the fewest leading components that hold that fraction of
  // the samples' variance; none if all samples are equal. Fails with
  // INVALID_TRAINING_DATA or INVALID_CONFIG.
  static absl::StatusOr<PcaNearest> Fit(const Eigen::MatrixXd& samples,
                                        const std::vector<int>& labels,
                                        double variance_share);

  // vector: [features], finite. Fails with INVALID_TRAINING_DATA.
  absl::StatusOr<Match> Predict(const Eigen::VectorXd& vector) const;

  int features() const { return static_cast<int>(basis_.rows()); }
  int components() const { return static_cast<int>(basis_.cols()); }

 private:
  PcaNearest() = default;

  Eigen::RowVectorXd mean_;  // [features]
  Eigen::MatrixXd basis_;    // [features x components], orthonormal columns
  Eigen::MatrixXd samples_;  // [components x samples], projected
  std::vector<int> labels_;  // [samples]
};

}  // namespace tactus::internal
