#include "core/hmm/kmeans.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/base/random.h"

namespace tactus {
namespace {

constexpr int kStarts = 8;
constexpr int kMaxRounds = 100;

// Indices of points drawn with probability proportional to their squared
// distance from those already drawn.
std::vector<int> DrawSeeds(const Eigen::MatrixXd& points, int clusters,
                           Random& random) {
  const int count = static_cast<int>(points.rows());
  std::vector<int> seeds = {static_cast<int>(random.Index(count))};
  Eigen::VectorXd distance =
      Eigen::VectorXd::Constant(count, std::numeric_limits<double>::max());
  while (static_cast<int>(seeds.size()) < clusters) {
    distance = distance.cwiseMin(
        (points.rowwise() - points.row(seeds.back())).rowwise().squaredNorm());
    const double total = distance.sum();
    if (!(total > 0)) break;  // every point coincides with a seed
    double rest = random.Uniform() * total;
    int drawn = -1;
    for (int p = 0; p < count; ++p) {
      if (distance[p] == 0) continue;
      drawn = p;
      rest -= distance[p];
      if (rest < 0) break;
    }
    seeds.push_back(drawn);
  }
  return seeds;
}

// Moves every point to its nearest centre; true if any changed.
bool Assign(const Eigen::MatrixXd& points, KMeansResult& result) {
  bool changed = false;
  result.inertia = 0;
  for (Eigen::Index p = 0; p < points.rows(); ++p) {
    Eigen::Index nearest = 0;
    result.inertia += (result.centres.rowwise() - points.row(p))
                          .rowwise()
                          .squaredNorm()
                          .minCoeff(&nearest);
    changed = changed || result.cluster_of[p] != nearest;
    result.cluster_of[p] = static_cast<int>(nearest);
  }
  return changed;
}

// Centres move to their points' means; clusters that lost all are removed.
void MoveCentres(const Eigen::MatrixXd& points, KMeansResult& result) {
  Eigen::MatrixXd sums =
      Eigen::MatrixXd::Zero(result.centres.rows(), points.cols());
  std::vector<int> sizes(result.centres.rows(), 0);
  for (Eigen::Index p = 0; p < points.rows(); ++p) {
    sums.row(result.cluster_of[p]) += points.row(p);
    ++sizes[result.cluster_of[p]];
  }
  std::vector<int> renamed(sizes.size(), 0);
  int kept = 0;
  for (size_t c = 0; c < sizes.size(); ++c) {
    if (sizes[c] == 0) continue;
    result.centres.row(kept) = sums.row(c) / sizes[c];
    renamed[c] = kept++;
  }
  result.centres.conservativeResize(kept, Eigen::NoChange);
  for (int& cluster : result.cluster_of) cluster = renamed[cluster];
}

}  // namespace

KMeansResult KMeans(const Eigen::MatrixXd& points, int clusters,
                    uint64_t seed) {
  KMeansResult best;
  best.inertia = std::numeric_limits<double>::infinity();
  for (int start = 0; start < kStarts; ++start) {
    Random random = Random::ForStream(seed, start);
    KMeansResult result;
    result.cluster_of.assign(points.rows(), -1);
    const std::vector<int> seeds = DrawSeeds(points, clusters, random);
    result.centres = points(seeds, Eigen::all);
    for (int round = 0; round < kMaxRounds && Assign(points, result); ++round) {
      MoveCentres(points, result);
    }
    if (result.inertia < best.inertia) best = std::move(result);
  }
  return best;
}

}  // namespace tactus
