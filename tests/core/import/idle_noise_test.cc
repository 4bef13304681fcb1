#include "core/import/idle_noise.h"

#include "core/base/errors.h"
#include "core/base/random.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

// `frames` of a 1 x 4 skin: noise up to 1 in the first `idle`, later 100 on
// taxel 3.
Trial Touched(uint64_t seed, int frames, int idle) {
  Random random(seed);
  Trial trial;
  trial.taxels.rows = 1;
  trial.taxels.columns = 4;
  for (int t = 0; t < frames; ++t) {
    for (int i = 0; i < 4; ++i) {
      const double load = t >= idle && i == 3 ? 100 : 0;
      trial.taxels.f32.push_back(static_cast<float>(load + random.Uniform()));
    }
  }
  return trial;
}

TEST(IdleNoiseTest, TheRuleOfTheHeaderHolds) {
  IdleNoise noise({.frames = 20});
  for (uint64_t seed = 0; seed < 50; ++seed) noise.Add(Touched(seed, 40, 20));
  const auto found = noise.Estimate();
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_EQ(found->values, 50u * 20 * 4);
  // Uniform from 0 to 1.
  EXPECT_NEAR(found->median, 0.5, 0.03);
  EXPECT_NEAR(found->percentile_999, 0.999, 0.002);
  EXPECT_LT(found->largest, 1);
  EXPECT_NEAR(found->peak, 101, 0.1);
  // 2 % of the peak is more than half of the spread.
  EXPECT_DOUBLE_EQ(found->margin, found->peak / 50);
  EXPECT_DOUBLE_EQ(found->contact_threshold,
                   found->percentile_999 + found->margin);
  EXPECT_DOUBLE_EQ(found->onset_threshold,
                   found->percentile_999 + 2 * found->margin);
}

// A recording that begins in contact has quiet taxels all the same.
TEST(IdleNoiseTest, TheQuietestTaxelsMayBeTaken) {
  IdleNoise frames({.frames = 20});
  IdleNoise taxels({.taxels = 0.5});
  for (uint64_t seed = 0; seed < 50; ++seed) {
    frames.Add(Touched(seed, 40, 0));
    taxels.Add(Touched(seed, 40, 0));
  }
  EXPECT_EQ(ReasonOf(frames.Estimate().status()), "INVALID_TRAINING_DATA");
  const auto found = taxels.Estimate();
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_EQ(found->values, 50u * 40 * 2);
  EXPECT_LT(found->largest, 1);
}

TEST(IdleNoiseTest, MaskedTaxelsDoNotCount) {
  Trial trial = Touched(1, 40, 0);
  SkinLayout skin;
  skin.mask = {1, 1, 1, 0};
  trial.skin = skin;
  IdleNoise noise({.frames = 40});
  noise.Add(trial);
  // Without the touched taxel everything is noise.
  const auto found = noise.Estimate();
  EXPECT_EQ(ReasonOf(found.status()), "INVALID_TRAINING_DATA");
  EXPECT_EQ(ReasonOf(IdleNoise({.frames = 1}).Estimate().status()),
            "INVALID_TRAINING_DATA");
}

// Beyond its bound the estimate keeps a part of the values, evenly.
TEST(IdleNoiseTest, ManyValuesAreThinnedOut) {
  IdleNoise noise({.frames = 50'000});
  for (uint64_t seed = 0; seed < 30; ++seed) {
    noise.Add(Touched(seed, 50'001, 50'000));
  }
  const auto found = noise.Estimate();
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_LE(found->values, 4'000'000u);
  EXPECT_GE(found->values, 2'000'000u);
  EXPECT_NEAR(found->percentile_999, 0.999, 1e-4);
}

}  // namespace
}  // namespace tactus::internal
