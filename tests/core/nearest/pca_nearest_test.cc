#include "core/nearest/pca_nearest.h"

#include <cmath>
#include <limits>
#include <vector>

#include "Eigen/SVD"
#include "core/base/errors.h"
#include "core/base/random.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

// Samples with decaying variance along random directions, off the origin.
Eigen::MatrixXd RandomSamples(int count, int features, Random& random) {
  const auto gaussian = [&random]() { return random.Gaussian(); };
  const Eigen::MatrixXd mixing =
      Eigen::MatrixXd::NullaryExpr(features, features, gaussian);
  Eigen::MatrixXd samples =
      Eigen::MatrixXd::NullaryExpr(count, features, gaussian);
  for (int k = 0; k < features; ++k) samples.col(k) *= std::pow(0.8, k);
  return ((samples * mixing).array() + 3).matrix();
}

std::vector<int> Labels(int count) {
  std::vector<int> labels;
  for (int k = 0; k < count; ++k) labels.push_back(7 * k % 4);
  return labels;
}

// Against Eigen's singular value decomposition of the samples themselves and
// a search over all of them, with more samples than features and fewer.
TEST(PcaNearestTest, MatchesSvdAndSearch) {
  Random random(81);
  for (const auto& [count, features] : {std::pair{60, 12}, std::pair{20, 50},
                                        std::pair{30, 30}, std::pair{1, 5}}) {
    const Eigen::MatrixXd samples = RandomSamples(count, features, random);
    const std::vector<int> labels = Labels(count);
    const Eigen::RowVectorXd mean = samples.colwise().mean();
    const Eigen::MatrixXd centred = samples.rowwise() - mean;
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(centred, Eigen::ComputeThinV);
    const Eigen::VectorXd variance = svd.singularValues().array().square();
    for (const double share : {0.5, 0.95, 0.999}) {
      const auto nearest = PcaNearest::Fit(samples, labels, share);
      ASSERT_TRUE(nearest.ok()) << nearest.status();
      int components = 0;
      while (variance.head(components).sum() < share * variance.sum()) {
        ++components;
      }
      EXPECT_EQ(nearest->components(), components);
      const Eigen::MatrixXd axes = svd.matrixV().leftCols(components);
      for (int round = 0; round < 20; ++round) {
        const Eigen::VectorXd query =
            RandomSamples(1, features, random).transpose();
        int best = -1;
        double least = std::numeric_limits<double>::infinity();
        for (int s = 0; s < count; ++s) {
          const double distance =
              ((samples.row(s) - query.transpose()) * axes).norm();
          if (distance < least) {
            least = distance;
            best = s;
          }
        }
        const auto match = nearest->Predict(query);
        ASSERT_TRUE(match.ok());
        EXPECT_EQ(match->sample, best);
        EXPECT_EQ(match->label, labels[best]);
        EXPECT_NEAR(match->distance, least, 1e-9 * (1 + least));
      }
    }
  }
}

TEST(PcaNearestTest, EverySampleIsNearestToItself) {
  Random random(82);
  const Eigen::MatrixXd samples = RandomSamples(40, 60, random);
  const auto nearest = PcaNearest::Fit(samples, Labels(40), 0.95);
  ASSERT_TRUE(nearest.ok());
  for (int s = 0; s < 40; ++s) {
    const auto match = nearest->Predict(samples.row(s).transpose());
    ASSERT_TRUE(match.ok());
    EXPECT_EQ(match->sample, s);
    EXPECT_NEAR(match->distance, 0, 1e-9);
  }
}

TEST(PcaNearestTest, EqualSamplesKeepNoComponentAndGiveTheFirstLabel) {
  const auto nearest =
      PcaNearest::Fit(Eigen::MatrixXd::Constant(3, 2, 0.5), {5, 6, 7}, 0.95);
  ASSERT_TRUE(nearest.ok());
  EXPECT_EQ(nearest->components(), 0);
  EXPECT_EQ(nearest->Predict(Eigen::Vector2d(1, 2))->label, 5);
}

// As long as the paper's trials: 3 x 500 values.
TEST(PcaNearestTest, FitsVectorsOfThePapersLength) {
  Random random(83);
  const Eigen::MatrixXd samples = Eigen::MatrixXd::NullaryExpr(
      300, 1500, [&random]() { return random.Gaussian(); });
  const auto nearest = PcaNearest::Fit(samples, Labels(300), 0.95);
  ASSERT_TRUE(nearest.ok());
  EXPECT_EQ(nearest->Predict(samples.row(234).transpose())->sample, 234);
}

TEST(PcaNearestTest, BadInputIsRefused) {
  const Eigen::MatrixXd good = Eigen::MatrixXd::Identity(3, 2);
  Eigen::MatrixXd nan = good;
  nan(1, 1) = std::nan("");
  struct Case {
    const char* reason;
    Eigen::MatrixXd samples;
    std::vector<int> labels;
    double share;
  };
  const Case cases[] = {
      {"INVALID_CONFIG", good, {1, 2, 3}, 0},
      {"INVALID_CONFIG", good, {1, 2, 3}, 1.01},
      {"INVALID_CONFIG", good, {1, 2, 3}, std::nan("")},
      {"INVALID_TRAINING_DATA", good, {1, 2}, 0.95},
      {"INVALID_TRAINING_DATA", nan, {1, 2, 3}, 0.95},
      {"INVALID_TRAINING_DATA", 1e200 * good, {1, 2, 3}, 0.95},
      {"INVALID_TRAINING_DATA", Eigen::MatrixXd(0, 2), {}, 0.95},
      {"INVALID_TRAINING_DATA", Eigen::MatrixXd(3, 0), {1, 2, 3}, 0.95},
  };
  for (const Case& c : cases) {
    EXPECT_EQ(ReasonOf(PcaNearest::Fit(c.samples, c.labels, c.share).status()),
              c.reason);
  }
  const auto nearest = PcaNearest::Fit(good, {1, 2, 3}, 0.95);
  ASSERT_TRUE(nearest.ok());
  EXPECT_FALSE(nearest->Predict(Eigen::Vector3d(1, 2, 3)).ok());
  EXPECT_FALSE(nearest->Predict(Eigen::Vector2d(1, std::nan(""))).ok());
}

}  // namespace
}  // namespace tactus::internal
