#include "core/sim/skin/signals.h"

#include <cmath>

#include "core/sim/model/materials.h"
#include "gtest/gtest.h"
#include "tests/support/find_material.h"

namespace tactus::internal {
namespace {

// k = 2 * 0.1 * 2e6 = 4e5 N/m; 4000 N press 0.01 m, a strain of 0.1;
// A' = 0.01 * 0.9^-1 with Poisson's ratio 0.5.
TEST(ContactAreaTest, MatchesHandComputedValues) {
  const Cube rubber = {*FindMaterial("natural-rubber"), 0.1, Surface::kWood};
  EXPECT_NEAR(Strain(rubber, 4000), 0.1, 1e-15);
  EXPECT_NEAR(ContactArea(rubber, 4000), 0.01 / 0.9, 1e-15);
  EXPECT_NEAR(ContactArea(rubber, 0), 0.01, 1e-15);
  // Fat of 0.01 m: k = 38 N/m, so 10 N would press it to 26 times its edge.
  const Cube fat = {*FindMaterial("fat"), 0.01, Surface::kWood};
  EXPECT_EQ(Strain(fat, 10), kMaxStrain);
  EXPECT_NEAR(ContactArea(fat, 10), 1e-4 * std::pow(0.05, -0.82), 1e-12);
}

TEST(AddNoiseTest, VarianceIsAFractionOfTheSignals) {
  std::vector<FeatureVector> clean(20000);
  for (size_t i = 0; i < clean.size(); ++i) {
    // Variance 1, 4 and 0.
    clean[i] = {i % 2 ? 1.0 : -1.0, i % 2 ? 2.0 : -2.0, 7};
  }
  std::vector<FeatureVector> noisy = clean;
  Random random(3);
  AddNoise({0.005, 0.0005, 0.0005}, random, noisy);
  FeatureVector variance = {};
  for (size_t i = 0; i < clean.size(); ++i) {
    for (int f = 0; f < 3; ++f) {
      variance[f] += std::pow(noisy[i][f] - clean[i][f], 2) / clean.size();
    }
  }
  EXPECT_NEAR(variance[0], 0.005, 0.0002);
  EXPECT_NEAR(variance[1], 0.002, 0.0001);
  EXPECT_EQ(variance[2], 0);
}

// A signal a thousand times as large has the same noise.
TEST(AddNoiseTest, AbsoluteNoiseDoesNotDependOnTheSignal) {
  const SignalNoise noise = {.reading = NoiseReading::kAbsolute};
  const FeatureVector shares = {noise.force, noise.area, noise.motion};
  for (double level : {1.0, 1000.0}) {
    std::vector<FeatureVector> clean(20000);
    for (size_t i = 0; i < clean.size(); ++i) {
      clean[i].fill(i % 2 == 0 ? level : -level);
    }
    std::vector<FeatureVector> noisy = clean;
    Random random(3);
    AddNoise(noise, random, noisy);
    FeatureVector variance = {};
    for (size_t i = 0; i < clean.size(); ++i) {
      for (int f = 0; f < 3; ++f) {
        variance[f] += std::pow(noisy[i][f] - clean[i][f], 2) / clean.size();
      }
    }
    for (int f = 0; f < 3; ++f) {
      const double expected = shares[f] * kMeanVariance[f];
      EXPECT_NEAR(variance[f], expected, 0.03 * expected);
    }
  }
}

TEST(ParseNoiseReadingTest, KnowsTwoNames) {
  EXPECT_EQ(*ParseNoiseReading("relative"), NoiseReading::kRelative);
  EXPECT_EQ(*ParseNoiseReading("absolute"), NoiseReading::kAbsolute);
  EXPECT_EQ(ParseNoiseReading("own").status().code(),
            absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace tactus::internal
