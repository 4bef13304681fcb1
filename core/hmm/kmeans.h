// File: kmeans.h
//
// k-means with k-means++ seeding (Arthur and Vassilvitskii, SODA 2007), the
// best of several starts. Used to group trials before their HMMs are trained.
//
//   KMeansResult clusters = KMeans(points, 10, seed);
//
// Thread-safe: a free function, deterministic given the seed.
#pragma once

#include <cstdint>
#include <vector>

#include "Eigen/Core"

namespace tactus {

struct KMeansResult {
  Eigen::MatrixXd centres;      // [clusters x dimensions]
  std::vector<int> cluster_of;  // [points]
  double inertia = 0;           // sum of squared distances to the centres
};

// points: [points x dimensions], finite, at least one. Gives `clusters`
// clusters, or fewer when there are fewer distinct points; each holds a point.
KMeansResult KMeans(const Eigen::MatrixXd& points, int clusters, uint64_t seed);

}  // namespace tactus
