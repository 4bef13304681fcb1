#include "core/sim/coupled/press_together.h"

#include <algorithm>
#include <cmath>

#include "core/base/errors.h"
#include "core/sim/exact/simulate_contact.h"
#include "gtest/gtest.h"
#include "tests/support/find_material.h"

namespace tactus::internal {
namespace {

TrialSpec Spec(const char* material, bool fixed = false) {
  TrialSpec spec;
  spec.object = {*FindMaterial(material), 0.05, Surface::kWood};
  spec.robot = {800, 0.01, kPaperGoal};
  spec.fixed = fixed;
  spec.retreat_after_s = 2.5;
  spec.retreat_speed_m_s = 0.02;
  return spec;
}

double Peak(const IdealSignals& signals, Feature feature) {
  double peak = 0;
  for (const FeatureVector& sample : signals.samples) {
    peak = std::max(peak, std::abs(sample[static_cast<int>(feature)]));
  }
  return peak;
}

// One object reads as SimulateContact says; a stiff one is softened for that.
TEST(PressTogetherTest, OneObjectReadsAsAlone) {
  for (const char* material : {"soft-foam", "muscle", "natural-rubber"}) {
    for (const bool fixed : {false, true}) {
      SimulateOptions without_area;
      without_area.area = false;
      const PressedObject object = {.spec = Spec(material, fixed)};
      const auto together = PressTogether({&object, 1});
      const auto alone = SimulateContact(object.spec, without_area);
      ASSERT_TRUE(together.ok() && alone.ok()) << together.status();
      const IdealSignals& got = together->front().signals;
      const IdealSignals& want = alone->signals;
      ASSERT_EQ(got.samples.size(), want.samples.size());
      EXPECT_EQ(together->front().Label(), alone->Label());
      for (const Feature f : {Feature::kForce, Feature::kMotion}) {
        for (size_t i = 0; i < got.samples.size(); ++i) {
          ASSERT_NEAR(got.samples[i][static_cast<int>(f)],
                      want.samples[i][static_cast<int>(f)],
                      1e-6 * Peak(want, f))
              << material << fixed << " sample " << i;
        }
      }
    }
  }
}

// A fixed object keeps the arm from one that lies as far as it gets alone.
TEST(PressTogetherTest, AFixedObjectHoldsTheArmBack) {
  const PressedObject soft = {.spec = Spec("muscle"), .distance_m = 0.005};
  const PressedObject wall = {.spec = Spec("natural-rubber", true)};
  const PressedObject both[] = {wall, soft};
  const auto alone = PressTogether({&soft, 1});
  const auto together = PressTogether(both);
  ASSERT_TRUE(alone.ok() && together.ok());
  EXPECT_GT(Peak(alone->front().signals, Feature::kForce), 0.5);
  EXPECT_EQ((*together)[1].signals.samples.size(),
            alone->front().signals.samples.size());
  EXPECT_LT(Peak((*together)[1].signals, Feature::kForce), 1e-12);
  EXPECT_LT(*ArmAfter(1.5, both), 0.005);
  EXPECT_GT(*ArmAfter(1.5, {&soft, 1}), 0.005);
}

TEST(PressTogetherTest, NothingToPressIsAnError) {
  EXPECT_EQ(ReasonOf(PressTogether({}).status()), "INVALID_SCENE");
}

}  // namespace
}  // namespace tactus::internal
