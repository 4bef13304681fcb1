#include "core/eval/learning_curve.h"

#include <cmath>

#include "gtest/gtest.h"
#include "tests/core/eval/synthetic_contacts.h"

namespace tactus::internal {
namespace {

using testing::PointersTo;
using testing::SyntheticContacts;

FitOptions SmallHmms() {
  FitOptions options = *FitPreset("paper");
  options.states = 2;
  options.max_iterations = 3;
  options.lstm.networks = 0;
  return options;
}

TEST(LearningCurveTest, EndsWithAllContacts) {
  const auto contacts = SyntheticContacts(24, 30, 0.05, 1);
  const auto curve =
      MeasureLearningCurve(PointersTo(contacts), Protocol(Protocol::kKFold, 3),
                           SmallHmms(), RunSerially);
  ASSERT_TRUE(curve.ok()) << curve.status();
  EXPECT_EQ(curve->tested, static_cast<int>(contacts.size()));
  std::vector<int> sizes;
  for (const CurvePoint& point : curve->points) {
    sizes.push_back(point.per_class);
    EXPECT_LE(point.right, curve->tested);
  }
  EXPECT_EQ(sizes, (std::vector<int>{5, 10, 20, 24}));
  // More than chance.
  EXPECT_GT(curve->points.back().right, curve->tested / 2);
  // The same again, whatever the threads.
  const auto again =
      MeasureLearningCurve(PointersTo(contacts), Protocol(Protocol::kKFold, 3),
                           SmallHmms(), RunSerially);
  for (size_t i = 0; i < curve->points.size(); ++i) {
    EXPECT_EQ(again->points[i].right, curve->points[i].right);
  }
}

TEST(LearningCurveTest, APowerLawIsContinued) {
  LearningCurve curve;
  curve.tested = 1'000'000;
  for (const int n : {5, 10, 20, 40}) {
    const double error = 0.5 / std::sqrt(n);
    curve.points.push_back({n, static_cast<int>(curve.tested * (1 - error))});
  }
  EXPECT_NEAR(*ExpectedAccuracy(curve, 160), 1 - 0.5 / std::sqrt(160), 1e-4);
}

TEST(LearningCurveTest, WhatDoesNotRiseIsNotContinued) {
  EXPECT_FALSE(ExpectedAccuracy({{{5, 40}, {10, 50}}, 100}, 20));
  EXPECT_FALSE(ExpectedAccuracy({{{5, 50}, {10, 50}, {20, 49}}, 100}, 40));
  // All right: half an error in 101 stays possible.
  EXPECT_GT(*ExpectedAccuracy({{{5, 90}, {10, 98}, {20, 100}}, 100}, 40), 0.99);
}

}  // namespace
}  // namespace tactus::internal
