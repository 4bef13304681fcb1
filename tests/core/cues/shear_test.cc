// Cues of shear, against closed forms.
#include <cmath>
#include <numbers>

#include "core/cues/cue_tracker.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

ContactSample Pulled(double force, double first, double second) {
  ContactSample sample = {{force, 1e-3, 0}, force};
  sample.shear = {static_cast<float>(first), static_cast<float>(second)};
  return sample;
}

double Value(CueTracker& tracker, absl::string_view name) {
  return tracker.value(NamedCue(name));
}

TEST(ShearCuesTest, AConstantPullIsDescribedByItsSizeAndDirection) {
  CueTracker tracker(100);
  for (int t = 1; t <= 200; ++t) tracker.Step(Pulled(10, 3, -4), t);
  EXPECT_NEAR(Value(tracker, "log_shear"), std::log(5), 1e-9);
  EXPECT_NEAR(Value(tracker, "log_shear_ratio"), std::log(0.5), 1e-9);
  EXPECT_NEAR(Value(tracker, "shear_cosine"), 0.6, 1e-9);
  EXPECT_NEAR(Value(tracker, "shear_sine"), -0.8, 1e-9);
  EXPECT_NEAR(Value(tracker, "shear_turn"), 1, 1e-9);
  EXPECT_NEAR(Value(tracker, "log_shear_rate"), 0, 1e-9);
  EXPECT_NEAR(Value(tracker, "log_shear_ratio_rate"), 0, 1e-9);
  // The floor of ripples.
  EXPECT_NEAR(Value(tracker, "shear_tremor_short"), std::log(1e-6), 1e-6);
}

TEST(ShearCuesTest, APullThatReversesTurns) {
  CueTracker tracker(100);
  for (int t = 1; t <= 200; ++t) tracker.Step(Pulled(10, 2, 0), t);
  // The mean of 10 frames turns before that of 40 does: with the weights w and
  // 1 - w of what was before.
  for (int t = 201; t <= 215; ++t) tracker.Step(Pulled(10, -2, 0), t);
  const double fast = std::pow(1 - 1.0 / 10, 15);
  const double slow = std::pow(1 - 1.0 / 40, 15);
  ASSERT_LT(2 * fast - 1, 0);
  ASSERT_GT(2 * slow - 1, 0);
  EXPECT_NEAR(Value(tracker, "shear_turn"), -1, 1e-9);
  // The size did not change.
  EXPECT_NEAR(Value(tracker, "log_shear_rate"), 0, 1e-9);
}

TEST(ShearCuesTest, RatesAreThoseOfShortOverLongMeans) {
  CueTracker tracker(100);
  for (int t = 1; t <= 200; ++t) tracker.Step(Pulled(10, 2, 0), t);
  for (int t = 201; t <= 210; ++t) tracker.Step(Pulled(5, 6, 0), t);
  const double fast = std::pow(1 - 1.0 / 10, 10);
  const double slow = std::pow(1 - 1.0 / 40, 10);
  const auto mean = [](double before, double now, double weight) {
    return weight * before + (1 - weight) * now;
  };
  const double size = std::log(mean(2, 6, fast) / mean(2, 6, slow));
  const double force = std::log(mean(10, 5, fast) / mean(10, 5, slow));
  EXPECT_NEAR(Value(tracker, "log_shear_rate"), size, 1e-9);
  EXPECT_NEAR(Value(tracker, "log_shear_ratio_rate"), size - force, 1e-9);
}

TEST(ShearCuesTest, ATremorIsRelativeToTheSize) {
  for (const double load : {1.0, 100.0}) {
    CueTracker tracker(100);
    for (int t = 1; t <= 2000; ++t) {
      // Changes of 0.2 across a pull of 4.
      const double across = t % 2 == 0 ? 0.1 : -0.1;
      tracker.Step(Pulled(10 * load, 4 * load, across * load), t);
    }
    EXPECT_NEAR(Value(tracker, "shear_tremor_short"),
                std::log(0.2 / std::hypot(4, 0.1)), 1e-6);
  }
}

TEST(ShearCuesTest, WithoutShearCuesAreFiniteAndConstant) {
  CueTracker tracker(100);
  std::vector<double> first;
  for (int t = 1; t <= 50; ++t) {
    tracker.Step(Pulled(10, 0, 0), t);
    std::vector<double> values;
    for (const Cue cue : CuesOfGroup("shear")) {
      EXPECT_TRUE(std::isfinite(tracker.value(cue))) << CueName(cue);
      values.push_back(tracker.value(cue));
    }
    if (t == 1) first = values;
    EXPECT_EQ(values, first);
  }
  EXPECT_EQ(first.size(), 8u);
}

}  // namespace
}  // namespace tactus::internal
