#include "tests/reference/sim/read_signals.h"

#include <algorithm>

#include "core/sim/model/materials.h"
#include "gtest/gtest.h"
#include "tests/support/find_material.h"

namespace tactus::internal {
namespace {

Trajectory ConstantPress(double force, double seconds_apart) {
  Trajectory trajectory;
  trajectory.sample_rate_hz = 2000;
  for (int i = 0; i <= 2000; ++i) {
    TrajectorySample sample;
    const double pressed = std::min(i / 2000.0, 1 - seconds_apart);
    sample.x_arm = 0.004;
    sample.impulse = force * pressed;
    sample.contact_time = pressed;
    trajectory.samples.push_back(sample);
  }
  return trajectory;
}

TEST(ReadSignalsTest, SettlesOnForceAreaAndMotion) {
  const Cube rubber = {*FindMaterial("natural-rubber"), 0.1, Surface::kWood};
  const IdealSignals signals = ReadSignals(rubber, ConstantPress(4000, 0));
  ASSERT_EQ(signals.samples.size(), 100);
  EXPECT_NEAR(signals.samples[50][0], 4000, 1e-3);
  EXPECT_NEAR(signals.samples[50][1], 0.01 / 0.9, 1e-8);
  EXPECT_NEAR(signals.samples[50][2], 0.004, 1e-9);
  EXPECT_EQ(signals.clamped, 0);
}

TEST(ReadSignalsTest, AreaAndForceAreZeroOnceContactIsLost) {
  const Cube rubber = {*FindMaterial("natural-rubber"), 0.1, Surface::kWood};
  const IdealSignals signals = ReadSignals(rubber, ConstantPress(4000, 0.5));
  EXPECT_GT(signals.samples[40][1], 0.01);
  EXPECT_NEAR(signals.samples[80][0], 0, 1e-6);
  EXPECT_NEAR(signals.samples[80][1], 0, 1e-12);
}

TEST(ReadSignalsTest, CountsClampedSamples) {
  const Cube fat = {*FindMaterial("fat"), 0.01, Surface::kWood};
  EXPECT_EQ(ReadSignals(fat, ConstantPress(10, 0)).clamped, 100);
  EXPECT_EQ(ReadSignals(fat, ConstantPress(10, 0.5)).clamped, 50);
}

}  // namespace
}  // namespace tactus::internal
