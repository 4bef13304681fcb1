#include "core/hmm/kmeans.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/random.h"

namespace tactus {
namespace {

constexpr int kStarts = 8;
constexpr int kMaxRounds = 100;

// Points and centres are columns, so that each is contiguous.
using Points = Eigen::MatrixXd;

double SquaredDistance(const Points& a, Eigen::Index i, const Points& b,
                       Eigen::Index j) {
  return (a.col(i) - b.col(j)).squaredNorm();
}

// Indices of points drawn with probability proportional to their squared
// distance from those already drawn.
std::vector<int> DrawSeeds(const Points& points, int clusters, Random& random) {
  const int count = static_cast<int>(points.cols());
  std::vector<int> seeds = {static_cast<int>(random.Index(count))};
  Eigen::VectorXd distance =
      Eigen::VectorXd::Constant(count, std::numeric_limits<double>::max());
  while (static_cast<int>(seeds.size()) < clusters) {
    for (int p = 0; p < count; ++p) {
      distance[p] = std::min(distance[p],
                             SquaredDistance(points, p, points, seeds.back()));
    }
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

// Lloyd's algorithm from one set of centres. Bounds on distances show that most
// points stay in their cluster (Hamerly, SDM 2010).
class Clustering {
 public:
  Clustering(const Points& points, const std::vector<int>& seeds)
      : points_(points),
        centres_(points(Eigen::all, seeds)),
        cluster_of_(points.cols(), -1),
        upper_(points.cols()),
        lower_(points.cols()) {}

  void Run() {
    for (int round = 0; round < kMaxRounds && Assign(); ++round) MoveCentres();
    inertia_ = 0;
    for (Eigen::Index p = 0; p < points_.cols(); ++p) {
      inertia_ += SquaredDistance(points_, p, centres_, cluster_of_[p]);
    }
  }

  double inertia() const { return inertia_; }
  KMeansResult Result() && {
    return {std::move(centres_), std::move(cluster_of_), inertia_};
  }

 private:
  // Larger than any rounding error of a bound.
  static constexpr double kSlack = 1 + 1e-9;

  // Moves every point to its nearest centre; true if any changed.
  bool Assign() {
    bool changed = false;
    for (Eigen::Index p = 0; p < points_.cols(); ++p) {
      if (bounded_ && upper_[p] * kSlack < lower_[p]) continue;
      if (bounded_) {
        upper_[p] =
            std::sqrt(SquaredDistance(points_, p, centres_, cluster_of_[p]));
        if (upper_[p] * kSlack < lower_[p]) continue;
      }
      const int before = cluster_of_[p];
      FindNearest(p);
      changed = changed || cluster_of_[p] != before;
    }
    bounded_ = true;
    return changed;
  }

  void FindNearest(Eigen::Index p) {
    double nearest = std::numeric_limits<double>::infinity();
    double second = nearest;
    for (Eigen::Index c = 0; c < centres_.cols(); ++c) {
      const double distance = SquaredDistance(points_, p, centres_, c);
      if (distance < nearest) {
        second = nearest;
        nearest = distance;
        cluster_of_[p] = static_cast<int>(c);
      } else {
        second = std::min(second, distance);
      }
    }
    upper_[p] = std::sqrt(nearest);
    lower_[p] = std::sqrt(second);
  }

  // Centres move to their points' means; clusters that lost all are removed.
  void MoveCentres() {
    Points moved = Points::Zero(points_.rows(), centres_.cols());
    std::vector<int> sizes(centres_.cols(), 0);
    for (Eigen::Index p = 0; p < points_.cols(); ++p) {
      moved.col(cluster_of_[p]) += points_.col(p);
      ++sizes[cluster_of_[p]];
    }
    std::vector<int> renamed(sizes.size(), 0);
    int kept = 0;
    for (size_t c = 0; c < sizes.size(); ++c) {
      if (sizes[c] == 0) continue;
      moved.col(kept) = moved.col(c) / sizes[c];
      renamed[c] = kept++;
    }
    if (kept < moved.cols()) {
      moved.conservativeResize(Eigen::NoChange, kept);
      for (int& cluster : cluster_of_) cluster = renamed[cluster];
      bounded_ = false;
    } else {
      LoosenBounds(moved);
    }
    centres_ = std::move(moved);
  }

  void LoosenBounds(const Points& moved) {
    const Eigen::VectorXd way = (moved - centres_).colwise().norm().transpose();
    const double longest = way.maxCoeff();
    for (Eigen::Index p = 0; p < points_.cols(); ++p) {
      upper_[p] += way[cluster_of_[p]];
      lower_[p] -= longest;
    }
  }

  const Points& points_;
  Points centres_;
  std::vector<int> cluster_of_;
  // Of the distance to the own centre, and to any other.
  Eigen::VectorXd upper_;
  Eigen::VectorXd lower_;
  bool bounded_ = false;
  double inertia_ = 0;
};

}  // namespace

KMeansResult KMeans(const Eigen::MatrixXd& points, int clusters,
                    uint64_t seed) {
  KMeansResult best;
  best.inertia = std::numeric_limits<double>::infinity();
  for (int start = 0; start < kStarts; ++start) {
    Random random = Random::ForStream(seed, start);
    Clustering clustering(points, DrawSeeds(points, clusters, random));
    clustering.Run();
    if (clustering.inertia() < best.inertia) {
      best = std::move(clustering).Result();
    }
  }
  return best;
}

}  // namespace tactus
