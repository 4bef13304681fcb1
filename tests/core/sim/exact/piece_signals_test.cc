#include "core/sim/exact/piece_signals.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/sim/exact/exact.h"
#include "core/sim/exact/simulate_contact.h"
#include "core/sim/skin/block_filter.h"
#include "core/sim/skin/butterworth.h"
#include "gtest/gtest.h"
#include "tests/reference/sim/cvode.h"
#include "tests/reference/sim/read_signals.h"
#include "tests/support/find_material.h"

namespace tactus::internal {
namespace {

// Sample by sample at 2 kHz (ReadSignals) and frame by frame in closed form
// give the same features.
TEST(PieceSignalsTest, AreThoseOfTheSampledTrajectory) {
  const struct {
    const char* material;
    double edge;
    double velocity;
    bool fixed;
    double retreat_after_s = std::numeric_limits<double>::infinity();
  } cases[] = {
      {"fat", 0.01, 0.02, false},        {"fat", 0.2, 0.005, false},
      {"light-foam", 0.1, 0.02, false},  {"muscle", 0.1, 0.02, false},
      {"steel", 0.1, 0.02, false},       {"steel", 0.01, 0.005, true},
      {"fat", 0.2, 0.02, false, 2.5},    {"muscle", 0.1, 0.02, false, 1.2},
      {"steel", 0.1, 0.02, true, 3.003}, {"steel", 0.05, 0.02, false, 2},
      {"abs-plastic", 0.01, 0.02, false}};
  for (const auto& c : cases) {
    TrialSpec spec;
    spec.object = {*FindMaterial(c.material), c.edge, Surface::kGlass};
    spec.robot.velocity = c.velocity;
    spec.fixed = c.fixed;
    spec.retreat_after_s = c.retreat_after_s;
    spec.retreat_speed_m_s = 0.05;
    const auto contact = SimulateContact(spec);
    const auto run = IntegrateExact(SceneOf(spec), {});
    ASSERT_TRUE(contact.ok() && run.ok());
    const IdealSignals want = ReadSignals(spec.object, *run);
    const IdealSignals& got = contact->signals;
    EXPECT_EQ(got.clamped, want.clamped) << c.material;
    EXPECT_EQ(got.object_motion.size(), 500);
    ASSERT_EQ(got.samples.size(), want.samples.size());
    for (int f = 0; f < kFeatureCount; ++f) {
      double peak = 0;
      for (const FeatureVector& s : want.samples) {
        peak = std::max(peak, std::abs(s[f]));
      }
      for (size_t i = 0; i < want.samples.size(); ++i) {
        ASSERT_NEAR(got.samples[i][f], want.samples[i][f], 1e-10 * peak)
            << c.material << " feature " << f << " sample " << i;
        ASSERT_NEAR(got.object_motion[i], run->samples[20 * (i + 1)].x_uobj,
                    1e-15);
      }
    }
  }
}

TEST(PieceSignalsTest, AreaIsLeftOutUnlessAskedFor) {
  TrialSpec spec;
  spec.object = {*FindMaterial("muscle"), 0.1, Surface::kGlass};
  SimulateOptions options;
  options.area = false;
  const auto with = SimulateContact(spec);
  const auto without = SimulateContact(spec, options);
  const auto by_cvode = SimulateByCvode(spec, {}, /*area=*/false);
  ASSERT_TRUE(with.ok() && without.ok() && by_cvode.ok());
  for (size_t i = 0; i < 500; ++i) {
    const double force = with->signals.samples[i][0];
    ASSERT_EQ(without->signals.samples[i][1], 0);
    ASSERT_EQ(without->signals.samples[i][0], force);
    ASSERT_EQ(by_cvode->signals.samples[i][1], 0);
    ASSERT_NEAR(by_cvode->signals.samples[i][0], force, 0.01);
  }
}

TEST(BlockFilterTest, IsButterworthStepByStep) {
  Butterworth6 steps(kAntiAliasHz, kSignalRateHz);
  const BlockFilter& blocks = BlockFilter::AntiAlias();
  BlockFilter::Column state = {};
  BlockFilter::Column closed = {};
  for (int frame = 0; frame < 50; ++frame) {
    BlockFilter::Inputs inputs;
    double want = 0;
    for (int j = 0; j < kFilterBlock; ++j) {
      inputs[j] = 2 + 0.25 * j;
      want = steps.Step(inputs[j]);
    }
    state = blocks.Step(state, inputs);
    BlockFilter::Column drive = {};
    Add(2, blocks.constant(), drive);
    Add(0.25, blocks.ramp(), drive);
    closed = blocks.Advance(closed, drive);
    EXPECT_NEAR(BlockFilter::Output(state), want, 1e-13);
    EXPECT_NEAR(BlockFilter::Output(closed), want, 1e-13);
  }
}

TEST(BlockFilterTest, TakesPowersOfARampAtOnce) {
  const BlockFilter& blocks = BlockFilter::AntiAlias();
  for (int n = 0; n < kRampPowers; ++n) {
    BlockFilter::Inputs inputs;
    for (int j = 0; j < kFilterBlock; ++j) {
      inputs[j] = std::pow((j - 9.5) / 10, n);
    }
    const BlockFilter::Column want = blocks.Drive(inputs);
    for (size_t i = 0; i < want.size(); ++i) {
      EXPECT_NEAR(blocks.ramp_power(n)[i], want[i], 1e-13) << n;
    }
  }
}

}  // namespace
}  // namespace tactus::internal
