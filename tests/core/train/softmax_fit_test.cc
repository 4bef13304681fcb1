#include "core/train/softmax_fit.h"

#include <cmath>
#include <limits>

#include "core/base/random.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

constexpr WeightBounds kBounds[] = {{0, 2}, {0, 2}};

struct Drawn {
  std::vector<std::vector<double>> first;
  std::vector<std::vector<double>> second;
  std::vector<ScoredLabel> contacts;
};

// Labels drawn from the softmax of 0.5 x first + 1.5 x second + (0, 0.4, -0.4).
Drawn Draw(int count) {
  Random random(5);
  Drawn drawn;
  const double bias[] = {0, 0.4, -0.4};
  for (int i = 0; i < count; ++i) {
    std::vector<double> a(3);
    std::vector<double> b(3);
    double weight[3];
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      a[k] = 2 * random.Gaussian();
      b[k] = random.Gaussian();
      sum += weight[k] = std::exp(0.5 * a[k] + 1.5 * b[k] + bias[k]);
    }
    double left = sum * random.Uniform();
    int label = 0;
    while (label < 2 && left >= weight[label]) left -= weight[label++];
    drawn.first.push_back(a);
    drawn.second.push_back(b);
    drawn.contacts.push_back({label, {}});
  }
  for (int i = 0; i < count; ++i) {
    drawn.contacts[i].scores = {drawn.first[i], drawn.second[i]};
  }
  return drawn;
}

double MeanLoss(const SoftmaxFit& fit, const Drawn& drawn) {
  double sum = 0;
  for (const ScoredLabel& contact : drawn.contacts)
    sum += LogLoss(fit, contact);
  return sum / static_cast<double>(drawn.contacts.size());
}

TEST(FitSoftmaxTest, FindsTheWeightsThatLabelsWereDrawnWith) {
  const Drawn drawn = Draw(20'000);
  const SoftmaxFit fit = FitSoftmax(drawn.contacts, kBounds, 3);
  EXPECT_NEAR(fit.weights[0], 0.5, 0.03);
  EXPECT_NEAR(fit.weights[1], 1.5, 0.05);
  EXPECT_NEAR(fit.bias[1] - fit.bias[0], 0.4, 0.06);
  EXPECT_NEAR(fit.bias[2] - fit.bias[0], -0.4, 0.06);
}

// No step away from a minimum lowers the loss.
TEST(FitSoftmaxTest, NoNeighbourIsBetter) {
  const Drawn drawn = Draw(2'000);
  const SoftmaxFit fit = FitSoftmax(drawn.contacts, kBounds, 3);
  const double loss = MeanLoss(fit, drawn);
  for (const double step : {-0.05, 0.05}) {
    for (int m = 0; m < 2; ++m) {
      SoftmaxFit other = fit;
      other.weights[m] += step;
      EXPECT_GT(MeanLoss(other, drawn), loss) << m;
    }
    for (int k = 0; k < 3; ++k) {
      SoftmaxFit other = fit;
      other.bias[k] += step;
      EXPECT_GT(MeanLoss(other, drawn), loss) << k;
    }
  }
}

// Nothing is infinite for scores that are always right, always equal or
// -infinity.
TEST(FitSoftmaxTest, SeparableDataStayWithinTheBounds) {
  const std::vector<double> right = {0, -1000};
  const std::vector<double> wrong = {-std::numeric_limits<double>::infinity(),
                                     0};
  const std::vector<double> equal = {-3, -3};
  const ScoredLabel contacts[] = {{0, {right, equal}}, {1, {wrong, equal}}};
  const SoftmaxFit fit = FitSoftmax(contacts, kBounds, 2);
  for (const double weight : fit.weights) {
    EXPECT_GE(weight, 0);
    EXPECT_LE(weight, 2);
  }
  for (const double bias : fit.bias) EXPECT_TRUE(std::isfinite(bias));
  for (const ScoredLabel& contact : contacts) {
    EXPECT_LT(LogLoss(fit, contact), 0.01);
  }
}

}  // namespace
}  // namespace tactus::internal
