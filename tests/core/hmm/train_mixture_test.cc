#include "core/hmm/train_mixture.h"

#include <cmath>
#include <set>
#include <vector>

#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/hmm/kmeans.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

TEST(KMeansTest, FindsWellSeparatedGroups) {
  Random random(71);
  Eigen::MatrixXd points(3, 60);
  for (int p = 0; p < 60; ++p) {
    for (int k = 0; k < 3; ++k) {
      points(k, p) = 10 * (p % 4 == k) + 0.1 * random.Gaussian();
    }
  }
  const KMeansResult result = KMeans(points, 4, 5);
  ASSERT_EQ(result.centres.cols(), 4);
  double inertia = 0;
  for (int p = 0; p < 60; ++p) {
    EXPECT_EQ(result.cluster_of[p], result.cluster_of[p % 4]);
    inertia += (points.col(p) - result.centres.col(result.cluster_of[p]))
                   .squaredNorm();
  }
  EXPECT_NEAR(result.inertia, inertia, 1e-9);
  EXPECT_EQ(
      std::set<int>(result.cluster_of.begin(), result.cluster_of.end()).size(),
      4u);
  EXPECT_EQ(KMeans(points, 4, 5).cluster_of, result.cluster_of);
}

// Where Lloyd's algorithm ends, in spite of all bounds.
TEST(KMeansTest, PointsAreWithTheNearestCentreAndCentresAreTheirMeans) {
  Random random(73);
  for (const int dimensions : {1, 3, 8}) {
    Eigen::MatrixXd points(dimensions, 400);
    for (double& x : points.reshaped()) x = random.Gaussian();
    const KMeansResult result = KMeans(points, 12, dimensions);
    ASSERT_EQ(result.centres.cols(), 12);
    Eigen::MatrixXd means = Eigen::MatrixXd::Zero(dimensions, 12);
    Eigen::VectorXd sizes = Eigen::VectorXd::Zero(12);
    for (int p = 0; p < points.cols(); ++p) {
      Eigen::Index nearest = 0;
      (result.centres.colwise() - points.col(p))
          .colwise()
          .squaredNorm()
          .minCoeff(&nearest);
      EXPECT_EQ(result.cluster_of[p], nearest) << p;
      means.col(nearest) += points.col(p);
      ++sizes[nearest];
    }
    means = means * sizes.cwiseInverse().asDiagonal();
    EXPECT_TRUE(means.isApprox(result.centres, 1e-12));
  }
}

TEST(KMeansTest, FewerDistinctPointsGiveFewerClusters) {
  Eigen::MatrixXd points = Eigen::MatrixXd::Zero(2, 5);
  EXPECT_EQ(KMeans(points, 3, 1).centres.cols(), 1);
  points(0, 4) = 1;
  EXPECT_EQ(KMeans(points, 3, 1).centres.cols(), 2);
}

// Two kinds of trials, rising and falling, and their index.
struct TwoKinds {
  std::vector<std::vector<double>> data;
  std::vector<SequenceView> views;
};
TwoKinds MakeTwoKinds(int rising, int falling) {
  Random random(72);
  TwoKinds kinds;
  for (int s = 0; s < rising + falling; ++s) {
    const double slope = s < rising ? 1 : -1;
    const int frames = 30 + static_cast<int>(random.Index(30));
    std::vector<double> x;
    for (int t = 0; t < frames; ++t) {
      x.push_back(slope * t / frames + 0.02 * random.Gaussian());
      x.push_back(0.02 * random.Gaussian());
    }
    kinds.data.push_back(std::move(x));
  }
  for (const std::vector<double>& x : kinds.data) {
    kinds.views.push_back({x.data(), static_cast<int>(x.size()) / 2, 2});
  }
  return kinds;
}

TEST(TrainMixtureTest, EachKindGetsItsComponent) {
  const TwoKinds kinds = MakeTwoKinds(30, 10);
  const auto trained =
      TrainMixture(kinds.views, {.components = 2, .states = 5});
  ASSERT_TRUE(trained.ok()) << trained.status();
  ASSERT_EQ(trained->mixture.components.size(), 2u);
  EXPECT_TRUE(Validate(trained->mixture).ok());
  for (int s = 0; s < 40; ++s) {
    EXPECT_EQ(trained->component_of[s], trained->component_of[s < 30 ? 0 : 39]);
  }
  EXPECT_NE(trained->component_of[0], trained->component_of[39]);
  EXPECT_NEAR(trained->mixture.log_weight[trained->component_of[0]],
              std::log(0.75), 1e-12);
  for (const BaumWelchReport& report : trained->reports) {
    EXPECT_TRUE(report.monotone);
  }
}

TEST(TrainMixtureTest, SmallGroupsAreMerged) {
  const TwoKinds kinds = MakeTwoKinds(30, 2);
  const auto trained = TrainMixture(
      kinds.views, {.components = 2, .states = 3, .min_trials = 4});
  ASSERT_TRUE(trained.ok());
  EXPECT_EQ(trained->mixture.components.size(), 1u);
  EXPECT_NEAR(trained->mixture.log_weight[0], 0, 1e-15);
  EXPECT_EQ(trained->component_of, std::vector<int>(32, 0));
}

TEST(TrainMixtureTest, EveryGroupHoldsEnoughTrials) {
  const TwoKinds kinds = MakeTwoKinds(25, 25);
  const auto trained = TrainMixture(
      kinds.views, {.components = 12, .states = 4, .min_trials = 5});
  ASSERT_TRUE(trained.ok());
  std::vector<int> sizes(trained->mixture.components.size(), 0);
  for (const int component : trained->component_of) ++sizes.at(component);
  for (const int size : sizes) EXPECT_GE(size, 5);
  EXPECT_TRUE(Validate(trained->mixture).ok());
  EXPECT_EQ(trained->reports.size(), sizes.size());
}

TEST(TrainMixtureTest, SameSeedSameBits) {
  const TwoKinds kinds = MakeTwoKinds(12, 12);
  const TrainMixtureOptions options = {.components = 4, .states = 4};
  const auto first = TrainMixture(kinds.views, options);
  const auto second = TrainMixture(kinds.views, options);
  ASSERT_TRUE(first.ok() && second.ok());
  EXPECT_EQ(first->component_of, second->component_of);
  EXPECT_EQ(first->mixture.log_weight, second->mixture.log_weight);
  for (size_t k = 0; k < first->mixture.components.size(); ++k) {
    EXPECT_EQ(first->mixture.components[k].means,
              second->mixture.components[k].means);
  }
}

TEST(TrainMixtureTest, BadOptionsAreRefused) {
  const TwoKinds kinds = MakeTwoKinds(5, 5);
  for (const TrainMixtureOptions& options :
       {TrainMixtureOptions{.components = 0},
        TrainMixtureOptions{.components = 257},
        TrainMixtureOptions{.states = 0}, TrainMixtureOptions{.max_jump = 0},
        TrainMixtureOptions{.min_trials = 0},
        TrainMixtureOptions{.summary_points = 0},
        TrainMixtureOptions{.baum_welch = {.covariance_floor = -1}}}) {
    EXPECT_EQ(ReasonOf(TrainMixture(kinds.views, options).status()),
              "INVALID_CONFIG");
  }
  EXPECT_EQ(ReasonOf(TrainMixture({}, {}).status()), "INVALID_TRAINING_DATA");
}

}  // namespace
}  // namespace tactus::internal
