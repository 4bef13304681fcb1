// File: kmeans.h
//
// k-means with k-means++ seeding (Arthur and Vassilvitskii, SODA 2007). Runs
// from several starts and keeps the result with the least inertia.
// train_mixture.h groups trials with it before it trains their HMMs.
//
//   KMeansResult clusters = KMeans(points, 10, seed);
//   clusters.cluster_of[i];  // the cluster of point i
//
// Thread-safe: a free function. The same seed gives the same bits. The result
// owns its arrays.
#pragma once

#include <cstdint>
#include <vector>

#include "Eigen/Core"
#include "core/base/work.h"

namespace tactus::internal {

struct KMeansResult {
  Eigen::MatrixXd centres;      // [dimensions x clusters]
  std::vector<int> cluster_of;  // [points]
  double inertia = 0;           // sum of squared distances to the centres
};

// points: [dimensions x points], finite, at least one. Returns `clusters`
// clusters, or fewer if there are fewer distinct points. No cluster is empty.
KMeansResult KMeans(const Eigen::MatrixXd& points, int clusters, uint64_t seed,
                    const ParallelFor& parallel = RunSerially);

}  // namespace tactus::internal
