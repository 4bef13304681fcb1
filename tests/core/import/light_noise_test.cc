#include "core/import/light_noise.h"

#include <cmath>

#include "core/base/random.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

// Noise of deviation 1 around 100; that of taxel 20 is `loud` times larger.
Trial NoisySkin(uint64_t seed, int frames, double loud) {
  Random random(seed);
  Trial trial;
  trial.layout = "cody-forearm";
  trial.unit = "newton";
  trial.taxels.rows = 16;
  trial.taxels.columns = 24;
  for (int i = 0; i < frames * 384; ++i) {
    const double noise = random.Gaussian() * (i % 384 == 20 ? loud : 1);
    trial.taxels.f32.push_back(static_cast<float>(100 + noise));
  }
  return trial;
}

// The deviation of independent readings' region mean: that of the smoothed
// reading and that of its background, which share a part of their frames.
double Expected() {
  const double fast = 1 - std::exp(-0.1);
  const double slow = 0.01;
  const double variance =
      fast / (2 - fast) + slow / (2 - slow) -
      2 * fast * slow * (1 - fast) / (1 - (1 - fast) * (1 - slow));
  return std::sqrt(variance / 9);
}

TEST(LightNoiseTest, ThresholdsAreDeviationsOfARegion) {
  LightNoise noise(20'000);
  noise.Add(NoisySkin(1, 20'000, 1));
  // The largest of 384 estimates.
  EXPECT_GT(noise.Deviation(), Expected());
  EXPECT_LT(noise.Deviation(), 1.25 * Expected());
  const auto light = noise.Estimate();
  ASSERT_TRUE(light.has_value());
  EXPECT_EQ(light->window_s, 0.1);
  EXPECT_EQ(light->rows, 3);
  EXPECT_EQ(light->columns, 3);
  EXPECT_DOUBLE_EQ(light->contact_threshold, 5 * noise.Deviation());
  EXPECT_DOUBLE_EQ(light->onset_threshold, 7 * noise.Deviation());
}

TEST(LightNoiseTest, TheNoisiestRegionCounts) {
  LightNoise noise(5'000);
  noise.Add(NoisySkin(2, 5'000, 9));
  const double nine = std::sqrt((8 + 81) / 9.0);
  EXPECT_NEAR(noise.Deviation() / Expected(), nine, 0.25 * nine);
}

TEST(LightNoiseTest, FewFramesOrNoNoiseGiveNothing) {
  LightNoise few(1'000);
  few.Add(NoisySkin(3, 229, 1));
  EXPECT_FALSE(few.Estimate().has_value());
  LightNoise early(100);
  early.Add(NoisySkin(3, 5'000, 1));
  EXPECT_FALSE(early.Estimate().has_value());
  // 70 frames of each of three trials.
  early.Add(NoisySkin(4, 5'000, 1));
  early.Add(NoisySkin(5, 5'000, 1));
  EXPECT_TRUE(early.Estimate().has_value());
  LightNoise silent(1'000);
  Trial trial = NoisySkin(6, 300, 1);
  for (float& taxel : trial.taxels.f32) taxel = 7;
  silent.Add(trial);
  EXPECT_FALSE(silent.Estimate().has_value());
  // No skin of this name.
  LightNoise unknown(1'000);
  trial = NoisySkin(6, 300, 1);
  trial.layout = "moon";
  unknown.Add(trial);
  EXPECT_FALSE(unknown.Estimate().has_value());
}

}  // namespace
}  // namespace tactus::internal
