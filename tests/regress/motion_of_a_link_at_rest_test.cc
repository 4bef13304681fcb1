// Motion was the length of the way from one noisy pose at onset, so a link at
// rest moved by more than the noise of its poses, in every frame and outwards.
#include <vector>

#include "core/base/random.h"
#include "core/features/contact_tracker.h"
#include "core/skin/geometry.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

constexpr double kPoseNoise = 50e-6;  // m on each axis
constexpr int kFramesBefore = 20;

struct MeanMotion {
  // Over all frames of many contacts, m.
  double bias = 0;
  // Root mean square over contacts of the mean over a contact, m.
  double spread = 0;
};

// Contacts at several places of a link that comes at `speed` (m/s) along the
// skin's normal and rests from the onset on, far from the origin.
MeanMotion MeasureRest(double speed) {
  const SkinLayout layout = *LayoutPreset("cody-forearm");
  ContactTracker tracker(layout, {});
  Random random(1);
  constexpr int kContacts = 300;
  constexpr int kFrames = 100;
  MeanMotion found;
  for (int contact = 0; contact < kContacts; ++contact) {
    tracker.Reset();
    const int taxel = static_cast<int>(random.Index(layout.taxels()));
    const Eigen::Vector3d normal = LinkNormal(
        layout, {.column = static_cast<double>(taxel % layout.columns)});
    std::vector<float> taxels(layout.taxels());
    double sum = 0;
    for (int i = -kFramesBefore; i < kFrames; ++i) {
      if (i == 0) taxels[taxel] = 1;
      Pose pose;
      for (double& coordinate : pose.position) {
        coordinate = 1000 + kPoseNoise * random.Gaussian();
      }
      pose.position += normal * (speed * std::min(i, 0) / 100);
      tracker.Step({.taxels = taxels, .pose = &pose});
      if (i >= 0) sum += tracker.features().motion_m / kFrames;
    }
    EXPECT_EQ(tracker.state(), ContactState::kInContact);
    found.bias += sum / kContacts;
    found.spread += sum * sum / kContacts;
  }
  found.spread = std::sqrt(found.spread);
  return found;
}

TEST(MotionOfALinkAtRestTest, HasNoBias) {
  const MeanMotion rest = MeasureRest(0);
  EXPECT_NEAR(rest.bias, 0, 3e-6);
  EXPECT_LT(rest.spread, 20e-6);
}

// The mean of the poses before onset would be 9.5 frames behind: 1.9 mm.
TEST(MotionOfALinkAtRestTest, NorAfterAnApproach) {
  const MeanMotion rest = MeasureRest(0.02);
  EXPECT_NEAR(rest.bias, 0, 5e-6);
  EXPECT_LT(rest.spread, 30e-6);
}

}  // namespace
}  // namespace tactus::internal
