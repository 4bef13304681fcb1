#include "core/hmm/kmeans.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/random.h"

namespace tactus::internal {
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
// points stay in their cluster, and which centres are too far from the others
// (Elkan, ICML 2003).
class Clustering {
 public:
  Clustering(const Points& points, const std::vector<int>& seeds)
      : points_(points),
        centres_(points(Eigen::all, seeds)),
        cluster_of_(points.cols(), -1),
        upper_(Eigen::VectorXd::Zero(points.cols())),
        lower_(seeds.size(), points.cols()) {}

  void Run() {
    for (int round = 0; round < kMaxRounds && Assign(); ++round) MoveCentres();
    inertia_ = 0;
    for (Eigen::Index p = 0; p < points_.cols(); ++p) {
      inertia_ += SquaredDistance(points_, p, centres_, cluster_of_[p]);
    }
  }

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
      const int before = cluster_of_[p];
      double to_own = 0;
      if (bounded_) {
        if (Stays(p)) continue;
        to_own = SquaredDistance(points_, p, centres_, before);
        upper_[p] = std::sqrt(to_own);
        if (Stays(p)) continue;
      }
      FindNearest(p, to_own);
      changed = changed || cluster_of_[p] != before;
    }
    bounded_ = true;
    return changed;
  }

  // True if each other centre is further away than the own one.
  bool Stays(Eigen::Index p) const {
    const double reach = upper_[p] * kSlack;
    bool stays = true;
    for (Eigen::Index c = 0; c < centres_.cols(); ++c) {
      stays &= c == cluster_of_[p] || lower_(c, p) > reach;
    }
    return stays;
  }

  // `to_own` is the squared distance to the own centre, if there are bounds.
  void FindNearest(Eigen::Index p, double to_own) {
    const int own = cluster_of_[p];
    const double reach = upper_[p] * kSlack;
    double nearest = std::numeric_limits<double>::infinity();
    for (Eigen::Index c = 0; c < centres_.cols(); ++c) {
      const bool known = bounded_ && c == own;
      if (bounded_ && !known && lower_(c, p) > reach) continue;
      const double distance =
          known ? to_own : SquaredDistance(points_, p, centres_, c);
      lower_(c, p) = std::sqrt(distance);
      if (distance < nearest) {
        nearest = distance;
        cluster_of_[p] = static_cast<int>(c);
      }
    }
    upper_[p] = std::sqrt(nearest);
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
    for (Eigen::Index p = 0; p < points_.cols(); ++p) {
      upper_[p] += way[cluster_of_[p]];
      lower_.col(p).head(way.size()) -= way;
    }
  }

  const Points& points_;
  Points centres_;
  std::vector<int> cluster_of_;
  // Bounds on the distance to the own centre, and to each [clusters x points].
  Eigen::VectorXd upper_;
  Eigen::MatrixXd lower_;
  bool bounded_ = false;
  double inertia_ = 0;
};

}  // namespace

KMeansResult KMeans(const Eigen::MatrixXd& points, int clusters, uint64_t seed,
                    const ParallelFor& parallel) {
  std::vector<KMeansResult> results(kStarts);
  parallel(kStarts, [&](int start) {
    Random random = Random::ForStream(seed, start);
    Clustering clustering(points, DrawSeeds(points, clusters, random));
    clustering.Run();
    results[start] = std::move(clustering).Result();
  });
  return std::move(*std::ranges::min_element(
      results, {}, [](const KMeansResult& result) { return result.inertia; }));
}

}  // namespace tactus::internal
